"""A campaign's folder from loggers' files: a run for each, and the calibration record of an ideal unit."""

from __future__ import annotations

import re
import shutil
from collections.abc import Sequence
from pathlib import Path

from fogreduce.datasets.atomic import TemporaryFile, write_text
from fogreduce.errors import BadInput
from fogreduce.guess.capture import Guess, Stated, guess
from fogreduce.guess.document import Bench, record_text, run_text, version_of
from fogreduce.metadata.instant import instant_text
from fogreduce.units import instant_of

_LONGEST_NAME = 64


def files_of(given: Sequence[Path]) -> list[Path]:
    """The files themselves and those of the folders, in order of their names; hidden ones are passed over."""
    files: list[Path] = []
    for path in given:
        if path.is_dir():
            found = sorted(p for p in path.iterdir() if p.is_file() and not p.name.startswith("."))
            if not found:
                raise BadInput.at(path, "", found="no file", expected="files of a logger")
            files += found
        else:
            files.append(path)
    return files


def begin_campaign(files: Sequence[Path], out: Path, stated: Stated, bench: Bench) -> list[Path]:
    """Write a campaign's folder; the runs' folders.

    Raises
    ------
    BadInput
        A file that cannot be read or does not tell enough; something that lies there already.
    """
    guesses = [guess(path, stated) for path in files]  # all are looked into before anything is written
    names = _names(files)
    records = {out / "calibrations" / bench.unit / f"{version_of(one)}.yaml": one for one in guesses}
    folders = [out / "runs" / name for name in names]
    for path in folders:
        if path.exists() or path.is_symlink():
            raise BadInput.at(
                path, "", found="a run already there", expected="a new folder (it is not overwritten)"
            )
    for source, one, folder in zip(files, guesses, folders, strict=True):
        folder.mkdir(parents=True)
        _copy(source, folder / source.name)
        started_at, why = _start(source, one)
        write_text(folder / "run.yaml", run_text(one, bench, folder.name, started_at, why))
    for path, one in records.items():
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text(path, record_text(one, bench))
    return folders


def _copy(source: Path, target: Path) -> None:
    file = TemporaryFile(target)
    try:
        shutil.copyfile(source, file.path)
    except OSError as error:
        file.finish(keep=False)
        raise BadInput.at(
            target, "", found=error.strerror, expected="a folder that can be written to"
        ) from None
    file.finish(keep=True)


def _start(source: Path, one: Guess) -> tuple[str, str]:
    """Start of the run, and why: by the stamps, else by the file's time of writing."""
    if one.start_us is not None:
        return instant_text(instant_of(one.start_us)), "the first stamp"
    ended = int(source.stat().st_mtime)
    start = instant_of((ended - int(one.duration_s)) * 1_000_000)
    return instant_text(start), "guessed: when the file was written, less its length"


def _names(files: Sequence[Path]) -> list[str]:
    """A run's name for each file: its own, as far as a name allows."""
    names: list[str] = []
    for path in files:
        stem = path.name.split(".")[0] or path.name
        plain = re.sub(r"[^A-Za-z0-9._-]+", "-", stem).strip("-._")[: _LONGEST_NAME - 4] or "run"
        name, k = plain, 1
        while name in names:
            k += 1
            name = f"{plain}-{k}"
        names.append(name)
    return names

"""Runs a diagnoser, somebody else's command, over a batch: it gets campaigns and calibrations alone."""

import resource
import shlex
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any

from withheld.atomic import read_json, write_json
from withheld.errors import BadInput

FIELDS = ("campaign", "calibrations", "out", "batch")


def _filled(template: str, **values: Path | str) -> list[str]:
    try:
        return [word.format(**values) for word in shlex.split(template)]
    except (KeyError, IndexError, ValueError) as error:
        raise BadInput(
            f"diagnoser {template!r}: expected only the fields {', '.join(FIELDS)} ({error!r})"
        ) from error


def _call(command: list[str]) -> dict[str, Any]:
    """Exit status, wall and processor seconds of one command; its last words where it failed."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    try:
        done = subprocess.run(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False
        )
    except OSError as error:
        raise BadInput(f"diagnoser {command[0]}: cannot be run ({error.strerror})") from error
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    result = {"exit": done.returncode, "wall_s": time.monotonic() - started, "cpu_s": cpu}
    return result if done.returncode == 0 else {**result, "said": done.stderr.strip()[-400:]}


def run_batch(template: str, batch: Path, out: Path) -> None:
    """Diagnoses into `out/<case>/`, and `out/timing.json`.

    A template with `{campaign}` is called once a case, with `--without EFFECT` added where the case asks for
    it; one with `{batch}` is called once, and reads public.json itself.  A command that fails leaves no
    diagnosis, which the scorer counts against it; one that cannot be started stops the study.
    """
    public = read_json(batch / "public.json")
    partial = out.with_name(f".{out.name}.part")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    timing: dict[str, Any] = {}
    if "{batch}" in template:
        result = _call(
            _filled(template, batch=batch, calibrations=batch / "calibrations", out=partial, campaign="")
        )
        each = {key: result[key] / len(public) for key in ("wall_s", "cpu_s")}
        timing = {case: {**result, **each} for case in public}
    elif "{campaign}" in template and "{out}" in template:
        for case, asked in sorted(public.items()):
            command = _filled(
                template, campaign=batch / "campaigns" / case, calibrations=batch / "calibrations",
                out=partial / case, batch=batch,
            )  # fmt: skip
            for effect in asked["without"]:
                command += ["--without", effect]
            timing[case] = _call(command)
    else:
        raise BadInput(
            f"diagnoser {template!r}: expected {{campaign}} and {{out}}, or {{batch}} and {{out}}, in it"
        )
    write_json(partial / "timing.json", timing)
    shutil.rmtree(out, ignore_errors=True)
    partial.rename(out)

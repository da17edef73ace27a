"""One run reduced into a folder: refused where another's results lie there, nothing half done left."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fogreduce.datasets.sole_writer import sole_writer
from fogreduce.progress import progress
from fogreduce.provenance.manifest_file import MANIFEST
from fogreduce.reruns.outdated import refuse_another_run, remove_outdated
from fogreduce.reruns.uses import refuse_rewritten
from fogreduce.stages.files import write_json
from fogreduce.stages.run import reduce_run
from fogreduce.stages.setup import Setup


def reduce_into(setup: Setup, run_dir: Path, calibrations: Path) -> None:
    """All stages of a run into its results folder; nothing of another run or version stays there."""
    with sole_writer(setup.out):
        refuse_another_run(setup.out, setup.manifest)
        used = setup.manifest["calibration"]
        out = setup.out.resolve()
        in_results = out.parts[-2:] == (setup.manifest["campaign"], setup.manifest["run_id"])
        refuse_rewritten(used["id"], used["sha256"], calibrations, out, neighbours=in_results)
        with _nothing_left(setup.out), progress(setup.facts.n_expected, "records") as advance:
            reduce_run(setup, run_dir, advance)
        remove_outdated(setup.out, setup.version_id)
        write_json(setup.out / MANIFEST, setup.manifest)


@contextmanager
def _nothing_left(out: Path) -> Iterator[None]:
    """Where the reduction fails, folders that it made and that are empty are removed."""
    made = [folder for folder in (out / "datasets", out, *out.parents) if not folder.exists()]
    try:
        yield
    except BaseException:
        for folder in made:
            with suppress(OSError):
                folder.rmdir()
        raise

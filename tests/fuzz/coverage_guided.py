"""Coverage-guided fuzzing of one kind of file by atheris, which is not among the pinned dependencies.

``pip install atheris``, then ``python tests/fuzz/coverage_guided.py NAME [--runs N] [--seconds S]``, NAME a
kind of file of `targets.py`. What stops it is left in a file ``crash-*`` of the folder it is called in.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
import tempfile
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "cli")]

try:
    import atheris
except ImportError:
    sys.exit("atheris is not installed: pip install atheris")

with atheris.instrument_imports(include=["fogreduce"]):
    from attempt import UNEXPECTED, Command, Outcome, called
    from fuzz_lab import FuzzLab
    from targets import FORBIDDEN, TARGETS, Target, made_ready

from judge import faults_of  # noqa: E402


class Mistake(Exception):
    """A command that did not answer as it must."""


def main() -> None:
    """Fuzz until the runs or the seconds are over, or something is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", choices=FORBIDDEN)
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--seconds", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    target = TARGETS[arguments.name]
    with tempfile.TemporaryDirectory(prefix="fogreduce-fuzz-") as folder:
        lab = FuzzLab(Path(folder).resolve() / "lab")
        with atheris.instrument_imports(include=["fogreduce"]):
            made_ready(lab, target)
        good = lab.good[target.file(lab)]
        corpus = Path(folder) / "corpus"
        corpus.mkdir()
        (corpus / "good").write_bytes(good)
        options = {
            "runs": arguments.runs,
            "max_total_time": arguments.seconds,
            "seed": arguments.seed,
            "max_len": 2 * len(good),
            "rss_limit_mb": 1000,
            "timeout": 60,
        }
        words = [f"-{key}={value}" for key, value in options.items()]
        atheris.Setup(
            [sys.argv[0], *words, str(corpus)], lambda data: _try(lab, target, arguments.name, data)
        )
        atheris.Fuzz()


def _try(lab: FuzzLab, target: Target, name: str, data: bytes) -> None:
    path = target.file(lab)
    path.write_bytes(data)
    before = lab.listing()
    try:
        for command in target.commands(lab):
            outcome = _outcome(command)
            if wrong := faults_of(outcome, FORBIDDEN[name](data), list(before), list(lab.listing())):
                raise Mistake(wrong)
            lab.tidy(before)
    finally:
        lab.mend(path)
        lab.tidy(before)


def _outcome(command: Command) -> Outcome:
    """In this process, so that the coverage is seen."""
    out, err = io.StringIO(), io.StringIO()
    status = UNEXPECTED
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = called(command)
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
    return Outcome(status, out.getvalue(), err.getvalue(), 0.0, 0.0)


if __name__ == "__main__":
    main()

"""Ten thousand spoilt files: what was refused, what was accepted, what went wrong, and what it cost.

``python tests/fuzz/ten_thousand.py [--examples N] [--seed N] [--only NAME,...]``; exit status 1 where a thing
went wrong. Each kind of mistake is shown once; the smallest file that makes it is kept in --keep DIR.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "cli")]

from fuzz_lab import FuzzLab  # noqa: E402
from hypothesis import HealthCheck, Phase, given, seed, settings  # noqa: E402
from targets import TARGETS, Figures, Spoilt, Target, made_ready, try_one  # noqa: E402


def main() -> int:
    """A line a kind of file; then each kind of mistake."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--examples", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--stricter", action="store_true", help="show what was refused though allowed")
    arguments = parser.parse_args()
    chosen = {
        name: target
        for name, target in TARGETS.items()
        if not arguments.only or name in arguments.only.split(",")
    }
    whole = sum(target.weight for target in chosen.values())
    mistakes = 0
    print("file                  examples  accepted  refused  mistakes  most CPU  most memory  time")
    for name, target in chosen.items():
        count = -(-arguments.examples * target.weight // whole)
        began = time.process_time() + sum(_children())
        with tempfile.TemporaryDirectory(prefix="fogreduce-fuzz-") as folder:
            lab = FuzzLab(Path(folder).resolve())
            made_ready(lab, target)
            figures = Figures()
            wrong = series(lab, target, count, arguments.seed, figures)
        took = time.process_time() + sum(_children()) - began
        print(
            f"{name:20s} {count:9d} {figures.accepted:9d} {figures.refused:8d} {len(wrong):9d} "
            f"{figures.most_cpu_s:7.2f} s {figures.most_mb:9.0f} MB {took:5.0f} s",
            flush=True,
        )
        for number, (text, data) in enumerate(wrong.values()):
            print(f"    mistake: {text}  [{len(data)} bytes]", flush=True)
            if arguments.keep:
                arguments.keep.mkdir(parents=True, exist_ok=True)
                (arguments.keep / f"{name} {number}").write_bytes(data)
        for line in sorted(figures.stricter.values()) if arguments.stricter else ():
            print("    stricter:", line, flush=True)
        mistakes += len(wrong)
    return 1 if mistakes else 0


def series(
    lab: FuzzLab, target: Target, count: int, number: int, figures: Figures
) -> dict[str, tuple[str, bytes]]:
    """Try `count` examples; each kind of mistake with its words and the smallest file."""
    wrong: dict[str, tuple[str, bytes]] = {}

    @seed(number)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(target.spoil(lab))
    def one(example: Spoilt) -> None:
        for text in try_one(lab, target, example, figures):
            key = "".join(letter for letter in text if not letter.isdigit())[:60]
            if key not in wrong or len(example.data) < len(wrong[key][1]):
                wrong[key] = (text, example.data)

    one()
    return wrong


def _children() -> tuple[float, float]:
    import resource

    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime, usage.ru_stime


if __name__ == "__main__":
    sys.exit(main())

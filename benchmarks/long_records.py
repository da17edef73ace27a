"""Seven days at 128 Hz: time and memory of every command that reads or writes the whole record.

A tenth of it first, so that what is not linear or not flat shows. Needs 14 GB of disk at the full length.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from measure import CALIBRATIONS, COMMAND, Measured, folder_mb, long_run, machine, parser, run, workplace

from fogreduce.cli.stage import STAGES

WEEK_S = 7 * 86_400
SHARES = (0.1, 1.0)


def main() -> None:
    """A table of user time, wall time and peak memory, a row a command, at a tenth and at the full length."""
    made = parser(__doc__ or "", 1)
    made.add_argument("--week", type=float, default=WEEK_S, help="full length [s] (default: %(default)s)")
    made.add_argument("--only", default="", help="commands to measure, comma between them (default: all)")
    arguments = made.parse_args()
    chosen = set(filter(None, arguments.only.split(",")))
    with workplace(arguments) as work:
        print(machine(), flush=True)
        found: list[dict[str, Measured]] = []
        for share in SHARES:
            duration_s = arguments.week * share
            found.append(measured(work, duration_s, chosen))
            sizes = [folder_mb(work / f"long-{duration_s:g}"), folder_mb(work / "out" / "datasets")]
            print(f"\n{duration_s:g} s: capture {sizes[0]:.0f} MB, datasets {sizes[1]:.0f} MB", flush=True)
            for name, item in found[-1].items():
                print(
                    f"  {name:14s} user {item.user_s:8.2f} s   wall {item.wall_s:8.2f} s   "
                    f"peak {item.peak_mb:6.1f} MB",
                    flush=True,
                )
            shutil.rmtree(work / "out")
            shutil.rmtree(work / f"long-{duration_s:g}")
        print("\ncommand: user time of the full length over a tenth; peak memory, full length less a tenth")
        for name in found[0]:
            short, whole = (part[name] for part in found)
            more_mb = whole.peak_mb - short.peak_mb
            print(f"  {name:14s} {whole.user_s / short.user_s:6.2f}   {more_mb:+6.1f} MB")


def measured(work: Path, duration_s: float, chosen: set[str]) -> dict[str, Measured]:
    """The commands one after another, the stages on what those before them left."""
    simulated: list[Measured] = []
    run_dir = long_run(work, duration_s, simulated)
    out, same = work / "out", ["--calibrations", CALIBRATIONS]
    shutil.rmtree(out, ignore_errors=True)
    commands: dict[str, list[object]] = {
        "reduce": ["reduce", run_dir, *same, "--out", out],
        "manifest": ["manifest", run_dir, *same, "--out", out],
        **{name: ["stage", name, "--out", out, "--run", run_dir] for name in STAGES},
        "checksums": ["checksums", out],
        "figures": ["figures", "--out", out],
    }
    found = {"simulate": simulated[0]} if simulated else {}
    for name, words in commands.items():
        if not chosen or name in chosen:
            found[name] = run([COMMAND, *words])
    return found


if __name__ == "__main__":
    main()

"""A record ten times as long: ten times the time, the same memory."""

from __future__ import annotations

import statistics

from measure import long_run, machine, parser, reduce, spread, workplace

SECONDS = (600, 6000, 60_000)


def main() -> None:
    """Wall and processor time and peak memory of records of 10 minutes, 100 minutes and 1000 minutes."""
    arguments = parser(__doc__ or "", 5).parse_args()
    with workplace(arguments) as work:
        print(machine())
        found = {}
        for seconds in SECONDS:
            run_dir = long_run(work, seconds)
            found[seconds] = [reduce(run_dir, work / "out") for _ in range(arguments.repetitions)]
            size = (run_dir / "capture.fogcap").stat().st_size / 1e6
            print(f"\n{seconds} s, {seconds * 128} records, capture of {size:.0f} MB")
            print(f"  wall [s]      {spread([item.wall_s for item in found[seconds]])}")
            print(f"  processor [s] {spread([item.cpu_s for item in found[seconds]])}")
            print(f"  peak memory [MB] {spread([item.peak_mb for item in found[seconds]], 1)}")
        short, middle, long = (statistics.median([item.cpu_s for item in found[key]]) for key in SECONDS)
        print(f"\nprocessor time, longest over middle: {long / middle:.2f} (10 is linear, less start-up)")
        slope = (long - short) / (middle - short)
        print(f"(longest - shortest) / (middle - shortest), free of start-up: {slope:.2f} (11 is linear)")


if __name__ == "__main__":
    main()

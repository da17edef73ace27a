"""`fogreduce reduce` against a straight C program on the reconstructed published run, in alternation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from measure import (
    CALIBRATIONS,
    REPOSITORY,
    Measured,
    compiled,
    folder_mb,
    machine,
    parser,
    published_run,
    reduce,
    run,
    spread,
    workplace,
)

from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import load_calibration, load_run

#: How the C program writes its numbers: all digits of a double, and nine decimals.
FORMATS = {"%.15e": (), "%.9f": ('-DFORMAT="%.9f"',)}


def facts_of(run_dir: Path) -> RunFacts:
    """The run's numbers, for the C program's parameters."""
    metadata = load_run(run_dir)
    record, _ = load_calibration(CALIBRATIONS, metadata.calibration)
    return RunFacts.of(metadata.model_dump(mode="json"), record.model_dump(mode="json"))


def write_parameters(facts: RunFacts, path: Path) -> Path:
    """What straight.c reads."""
    assert facts.projection is not None
    earth = np.column_stack((facts.earth.constant, facts.earth.cosine, facts.earth.sine))
    parts = (facts.polarity, facts.scale_factor, facts.bias, facts.projection, earth)
    numbers = [
        facts.least_count,
        facts.profile.rate_deg_s[0],
        *np.concatenate([part.ravel() for part in parts]),
    ]
    path.write_text(" ".join([str(facts.n_gyros), *(repr(float(number)) for number in numbers)]) + "\n")
    return path


def compare_rates(text: Path, dataset: Path) -> float:
    """Largest difference between the C program's rates and ours [deg/s], records that both have."""
    import h5py

    lines = np.loadtxt(text)
    with h5py.File(dataset) as file:
        rates = file["axis_rate"][:]
    ours = rates[:, np.isfinite(rates).all(axis=0)]
    return float(np.abs(ours - lines[:, 1:].T).max())


def main() -> None:
    """Pairs, their ratios, the memory, and proof that both computed the same."""
    options = parser(__doc__ or "", 15)
    options.add_argument("--check", action="store_true", help="compare all rates of both, too")
    arguments = options.parse_args()
    with workplace(arguments) as work:
        print(machine())
        run_dir = published_run(work)
        parameters = write_parameters(facts_of(run_dir), work / "parameters.txt")
        text, out = work / "rates.txt", work / "out"
        for form, flags in FORMATS.items():
            program = compiled(REPOSITORY / "benchmarks" / "straight.c", work / "straight", *flags)
            pairs: list[tuple[Measured, Measured]] = []
            for _ in range(arguments.repetitions):
                text.unlink(missing_ok=True)
                straight = run([program, parameters, run_dir / "capture.fogcap", text])
                pairs.append((reduce(run_dir, out), straight))
            ours, theirs = zip(*pairs, strict=True)
            size = text.stat().st_size / 1e6
            print(f"\nC program writing {form} ({size:.0f} MB); {len(pairs)} pairs, in turn")
            print(f"  fogreduce wall [s]       {spread([item.wall_s for item in ours])}")
            print(f"  C program wall [s]       {spread([item.wall_s for item in theirs])}")
            print(f"  ratio of wall times      {spread([a.wall_s / b.wall_s for a, b in pairs])}")
            fastest = min(item.wall_s for item in ours) / min(item.wall_s for item in theirs)
            print(f"  ratio of the fastest of each {fastest:.3f}")
            print(f"  fogreduce processor [s]  {spread([item.cpu_s for item in ours])}")
            print(f"  C program processor [s]  {spread([item.cpu_s for item in theirs])}")
            print(f"  ratio of processor times {spread([a.cpu_s / b.cpu_s for a, b in pairs])}")
            print(f"  fogreduce peak memory [MB] {spread([item.peak_mb for item in ours], 1)}")
            print(f"  fogreduce results {folder_mb(out):.0f} MB")
        if arguments.check:
            # Last, since what this process holds in memory would count as its children's.
            program = compiled(REPOSITORY / "benchmarks" / "straight.c", work / "straight")
            run([program, parameters, run_dir / "capture.fogcap", text])
            difference = compare_rates(text, out / "datasets" / "remove_earth.nc")
            print(f"\nlargest difference of a rate between the two: {difference:.1e} deg/s")


if __name__ == "__main__":
    main()

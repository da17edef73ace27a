"""Pulls of derived calibrations: `python benchmarks/derivation_pulls.py [CAMPAIGNS]` (200 by default).

Campaigns of several designs are simulated with every stated uncertainty drawn; each derived parameter less
the truth, in its standard error, is a pull. The whole vector of a campaign, brought to independent values by
its covariance, tests the off-diagonals too. Kolmogorov's test says whether they are standard normal.
"""

from __future__ import annotations

import sys
import tempfile
from collections import defaultdict
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np
from scipy.stats import kstest

from fogreduce.calibrate.derive import derive
from fogreduce.calibrate.record import candidate

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "calibrate"))
from calibration_bench import UP, Bench, BenchRun, drawn_in, errors

#: Design -> what stands up in each run, and its profile (rate deg/s, seconds).
DESIGNS: dict[str, list[tuple[str, list[tuple[float, float]]]]] = {
    "a run each sense, slow, still": [
        *[(axis, [(sign * 10.0, 72.0)]) for axis in "xyz" for sign in (1, -1)],
        ("x", [(0.5, 72.0)]),
        ("x", [(0.0, 72.0)]),
    ],
    "both senses and still in a run, twice": [
        (axis, [(10.0, 30.0), (-10.0, 30.0), (0.0, 30.0)]) for axis in "xyzxyz"
    ],
    "six rests and three turns": [
        *[(up, [(0.0, 72.0)]) for up in UP],
        *[(axis, [(20.0, 36.0), (-20.0, 36.0)]) for axis in "xyz"],
    ],
    "several rates": [
        (axis, [(rate, 24.0) for rate in (30.0, 10.0, -10.0, -30.0)]) for axis in "xyz" for _ in (0, 1)
    ],
}


def main() -> None:
    """Print the table."""
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    pulls: dict[str, list[float]] = defaultdict(list)
    for k in range(number):
        design = list(DESIGNS)[k % len(DESIGNS)]
        with tempfile.TemporaryDirectory() as name:
            bench = Bench(Path(name))
            runs = [BenchRun(f"r{i}", up, profile) for i, (up, profile) in enumerate(DESIGNS[design])]
            with redirect_stdout(StringIO()):
                options = ["--draw-uncertainties", "--seed", str(5000 + k)]
                campaign = bench.simulate(runs=runs, options=options)
            found = derive(campaign, bench.calibrations)
            assert not found.undetermined
            candidate(found, campaign, "b")
            left, covariance = errors(found, drawn_in(campaign)), found.parameters.covariance
        # Of one gyro a campaign: what the table's rate is off by moves the scale factors of all.
        each = (left / np.sqrt(np.diag(covariance))).reshape(-1, 4)[k // len(DESIGNS) % 4]
        for what, value in zip(("bias", "scale factor", "axis, first", "axis, second"), each, strict=True):
            pulls[what].append(float(value))
        whitened = np.linalg.solve(np.linalg.cholesky(covariance), left)
        pulls["all, with off-diagonals"] += whitened.tolist()
        pulls[design] += whitened.tolist()
    print(f"{number} campaigns")
    for what, values in pulls.items():
        p = kstest(values, "norm").pvalue
        print(f"{what:38} {len(values):5} mean {np.mean(values):+.3f} std {np.std(values):.3f} p {p:.3g}")


if __name__ == "__main__":
    main()

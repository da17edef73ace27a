"""Allan deviation of 4 gyros x 768,000 samples at about 90 averaging times, beside allantools.

``python benchmarks/allan.py``: processor time of each, best of five, and their ratio. Ours is the overlapping
deviation with its 68 % and 95 % limits; allantools' `oadev` comes without them (its error bar is no limit).
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from fogreduce.characterise.allan_channel import channel_of
from fogreduce.estimate.allan_variance import Series, overlapping

GYROS, SAMPLES, RATE_HZ, TIMES, ROUNDS = 4, 768_000, 128.0, 100, 5


def best(call: Callable[[], object]) -> float:
    """Least processor time of a few rounds [s]."""
    times = []
    for _ in range(ROUNDS):
        began = time.process_time()
        call()
        times.append(time.process_time() - began)
    return min(times)


def main() -> None:
    """Measure and print."""
    import allantools
    import scipy.special  # noqa: F401  (its import is no part of either)

    rates = np.random.default_rng(0).normal(size=(GYROS, SAMPLES))
    factors = np.unique(np.geomspace(1, SAMPLES // 4, TIMES).astype(int)).tolist()
    taus = np.array(factors) / RATE_HZ

    def ours() -> None:
        for row in rates:
            channel_of("gyro", row, 1 / RATE_HZ, ("overlapping",), factors, "", density=False)

    def theirs() -> None:
        for row in rates:
            allantools.oadev(row, rate=RATE_HZ, data_type="freq", taus=taus)

    _, deviations, _, _ = allantools.oadev(rates[0], rate=RATE_HZ, data_type="freq", taus=taus)
    series = Series(rates[0])
    assert np.allclose([overlapping(series, m).variance for m in factors], deviations**2, rtol=1e-9)
    mine, other = best(ours), best(theirs)
    print(f"{GYROS} x {SAMPLES} samples, {len(factors)} averaging times")
    print(f"fogreduce, with limits: {mine:.2f} s; allantools oadev: {other:.2f} s; ratio {other / mine:.1f}")


if __name__ == "__main__":
    main()

"""The interval of samples from stamps: the stated one unless the stamps contradict it."""

import numpy as np
import pytest

from fogreduce.estimate.sample_interval import sample_interval_s

N = 20_000
PULSE = np.arange(N)


def stamps(rate_hz, jitter_s=0.0, resolution_us=1):
    noise = np.random.default_rng(1).normal(0.0, jitter_s, N) if jitter_s else 0.0
    time_us = (PULSE / rate_hz + noise) * 1e6
    return (np.rint(time_us / resolution_us) * resolution_us).astype(np.int64)


@pytest.mark.parametrize(
    ("rate_hz", "jitter_s", "resolution_us"),
    [
        (100.0, 0.0, 1),
        (30.0, 0.0, 1),  # an interval that is no whole number of microseconds
        (128.0, 0.0, 1000),
        (100.0, 4e-3, 1),
        (10.0, 0.0, 1_000_000),  # stamps of whole seconds
    ],
)
def test_the_stated_rate_stands_where_the_stamps_agree(rate_hz, jitter_s, resolution_us):
    assert sample_interval_s(PULSE, stamps(rate_hz, jitter_s, resolution_us), rate_hz) == 1 / rate_hz


@pytest.mark.parametrize(("jitter_s", "resolution_us"), [(0.0, 1), (4e-3, 1), (0.0, 1_000_000)])
def test_a_rate_that_is_off_by_one_per_cent_is_that_of_the_stamps(jitter_s, resolution_us):
    found = sample_interval_s(PULSE, stamps(101.0, jitter_s, resolution_us), 100.0)
    # half the record apart: 99 s, in which the scatter of two stamps, 1 s at most, goes by its mean
    assert found == pytest.approx(1 / 101.0, rel=1e-4 if resolution_us == 1 else 5e-3)


def test_lost_and_repeated_records_and_wrong_stamps_do_not_matter():
    time_us = stamps(101.0)
    kept = np.sort(np.concatenate((np.delete(PULSE, np.s_[3000:3700]), [50, 51, 52])))
    time_us = time_us[kept]
    time_us[700:720] += 10_000_000
    assert sample_interval_s(PULSE[kept], time_us, 100.0) == pytest.approx(1 / 101.0, rel=1e-7)


@pytest.mark.parametrize("n", [0, 1, 2, 3])
def test_few_records(n):
    assert sample_interval_s(PULSE[:n], stamps(100.0)[:n], 100.0) == 0.01

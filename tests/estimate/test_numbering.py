"""Numbers by stamps, the true ones known by construction: whatever the clock does, no record is lost."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.datasets.block import RawBlock
from fogreduce.estimate.clock import StampClock
from fogreduce.estimate.numbering import Numbering

K = np.arange(40_000)


def numbered(stamp_s, rate_hz=100.0, block=65_536, readings=None):
    """Numbers, mended stamps [us], wrong stamps and clock."""
    time_us = np.rint(np.asarray(stamp_s) * 1e6).astype(np.int64)
    values = np.random.default_rng(7).normal(size=(2, time_us.size)) if readings is None else readings
    raw = (
        RawBlock(k, time_us[k : k + block], None, None, values[:, k : k + block])
        for k in range(0, time_us.size, block)
    )
    clock = StampClock(rate_hz)
    parts = list(Numbering(clock).blocks(raw))
    number = np.concatenate([part.pulse for part, _ in parts])
    mended = np.concatenate([part.time_us for part, _ in parts])
    return number, mended, np.concatenate([wrong for _, wrong in parts]), clock


def jitter(size_s: float) -> np.ndarray:
    return np.random.default_rng(3).normal(0.0, size_s, K.size)


GOOD = {
    "even": (K / 100, 100.0),
    "a rate of 101 Hz": (K / 101, 100.0),
    "whole seconds": (np.floor(K / 100), 100.0),
    "a short record in whole seconds": (np.floor(K[:2000] / 100), 100.0),
    "whole milliseconds, 4 ms of jitter": (np.round(K / 100 + jitter(4e-3), 3), 100.0),
    "half an interval of jitter": (K / 100 + np.random.default_rng(1).uniform(-5e-3, 5e-3, K.size), 100.0),
    "bunches of 16": (np.ceil((K + 1) / 16) * 0.16, 100.0),
    "one in 50 s": (K[:40] * 50.0, 0.02),
}


@pytest.mark.parametrize("name", GOOD)
def test_good_records_are_numbered_in_their_order(name: str) -> None:
    stamp_s, rate_hz = GOOD[name]
    number, _, wrong, _ = numbered(stamp_s, rate_hz)
    np.testing.assert_array_equal(number, np.arange(len(stamp_s)))
    assert not wrong.any()


@pytest.mark.parametrize("block", [333, 16_384, 20_000])
@pytest.mark.parametrize("name", ["whole seconds", "whole milliseconds, 4 ms of jitter"])
def test_the_size_of_blocks_does_not_matter(name: str, block: int) -> None:
    stamp_s, rate_hz = GOOD[name]
    one, other = numbered(stamp_s, rate_hz), numbered(stamp_s, rate_hz, block)
    for mine, theirs in zip(one[:3], other[:3], strict=True):
        np.testing.assert_array_equal(mine, theirs)
    assert (one[3].rate_hz, one[3].jitter_s) == (other[3].rate_hz, other[3].jitter_s)


@pytest.mark.parametrize("scatter_s", [0.0, 4e-3])
def test_a_hole_of_five_seconds(scatter_s: float) -> None:
    kept = np.delete(K, slice(1000, 1500))
    number, _, _, _ = numbered(kept / 100 + jitter(scatter_s)[: kept.size])
    np.testing.assert_array_equal(number, kept)


def test_single_records_lost_at_random() -> None:
    kept = K[np.random.default_rng(2).random(K.size) > 0.01]
    np.testing.assert_array_equal(numbered(kept / 101)[0], kept - kept[0])


def test_a_record_sent_again_and_two_exchanged() -> None:
    order = np.concatenate((K[:5000], [4999], K[5000:]))
    order[[7000, 7001]] = order[[7001, 7000]]
    readings = np.random.default_rng(7).normal(size=(2, K.size))[:, order]
    np.testing.assert_array_equal(numbered(order / 100, readings=readings)[0], order)


def test_a_doubled_stamp_and_one_that_is_wrong() -> None:
    stamp_s = K / 100
    stamp_s[16_384] = stamp_s[16_383]
    stamp_s[300] += 50.0
    number, _, wrong, clock = numbered(stamp_s)
    np.testing.assert_array_equal(number, K)
    assert (clock.doubled, np.flatnonzero(wrong).tolist()) == (1, [300])


@pytest.mark.parametrize("scatter_s", [0.0, 4e-3])
def test_a_step_back_is_taken_out(scatter_s: float) -> None:
    stamp_s = K / 100 + jitter(scatter_s)
    stamp_s[20_000:] -= 10.0
    number, mended_us, wrong, clock = numbered(stamp_s)
    np.testing.assert_array_equal(number, K)
    assert not wrong.any()
    ((record, seconds),) = clock.steps_back
    assert record == 20_000
    assert seconds == pytest.approx(10.0, abs=8 * scatter_s + 1e-9)
    assert np.abs(mended_us / 1e6 - K / 100).max() < 12 * scatter_s + 1e-9


def test_a_counter_that_wraps() -> None:
    number, mended_us, _, clock = numbered(K / 100 % 65.536)
    np.testing.assert_array_equal(number, K)
    assert len(clock.steps_back) == int(399.99 / 65.536)
    assert np.abs(mended_us / 1e6 - K / 100).max() < 0.01 * len(clock.steps_back)


@pytest.mark.parametrize("start_s", [5.0, -5.0])
def test_a_record_that_starts_elsewhere(start_s: float) -> None:
    np.testing.assert_array_equal(numbered(K / 100 + start_s)[0], K + round(100 * start_s))


def test_the_clock_is_measured() -> None:
    clock = numbered(K / 101 + jitter(1e-3))[3]
    assert clock.rate_hz == pytest.approx(101.0, rel=1e-6)
    assert clock.jitter_s == pytest.approx(1e-3, rel=0.03)

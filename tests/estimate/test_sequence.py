"""The order of records: cases by hand, then against a model that goes record by record."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fogreduce.datasets.flags import RecordFlag
from fogreduce.estimate.sequence import SequenceCheck

RATE_HZ = 128.0
GOOD = 0
REPEATED, LATE = int(RecordFlag.REPEATED), int(RecordFlag.OUT_OF_ORDER)
BAD, BEYOND = int(RecordFlag.BAD_STAMP), int(RecordFlag.BEYOND_PROFILE)


def stamps(pulses: np.ndarray) -> np.ndarray:
    return np.rint(pulses / RATE_HZ * 1e6).astype(np.int64)


def checked(
    pulses: list[int], block: int = 10**6, expected: int = 1000, time_us: np.ndarray | None = None
) -> tuple[list[int], SequenceCheck]:
    """Flags of all records, judged `block` at a time, and what the check knows at the end."""
    numbers = np.array(pulses, np.int64)
    times = stamps(numbers) if time_us is None else time_us
    check = SequenceCheck(RATE_HZ, expected)
    flags: list[int] = []
    for start in range(0, numbers.size, block):
        part = slice(start, start + block)
        flags += check.flags(times[part], numbers[part]).tolist()
    return flags, check


blocks = pytest.mark.parametrize("block", [1, 2, 3, 5, 1000])


# -------------------------------------------------------------------------------------- by hand


@blocks
def test_a_whole_record(block: int) -> None:
    flags, check = checked(list(range(20)), block, expected=20)
    assert flags == [GOOD] * 20
    assert (check.lost(), check.holes()) == (0, [])


@blocks
def test_lost_records_leave_holes(block: int) -> None:
    flags, check = checked([0, 1, 4, 5, 9], block, expected=12)
    assert flags == [GOOD] * 5
    assert check.lost() == 7
    assert check.holes() == [(2, 2), (6, 3), (10, 2)]


@blocks
def test_a_record_that_starts_late_and_ends_early(block: int) -> None:
    flags, check = checked([3, 4, 5], block, expected=10)
    assert flags == [GOOD] * 3
    assert check.holes() == [(0, 3), (6, 4)]
    assert check.lost() == 7


@blocks
def test_repeated_records_count_once_the_first_time(block: int) -> None:
    flags, check = checked([0, 1, 1, 2, 0, 3, 3, 3], block, expected=4)
    assert flags == [GOOD, GOOD, REPEATED, GOOD, REPEATED, GOOD, REPEATED, REPEATED]
    assert check.lost() == 0


@blocks
def test_a_late_record_fills_its_hole_once(block: int) -> None:
    flags, check = checked([0, 1, 4, 2, 2, 5, 3, 3, 1], block, expected=6)
    assert flags == [GOOD, GOOD, GOOD, LATE, REPEATED, GOOD, LATE, REPEATED, REPEATED]
    assert (check.lost(), check.holes()) == (0, [])


@blocks
def test_a_hole_filled_in_its_middle(block: int) -> None:
    _, check = checked([0, 10, 5], block, expected=11)
    assert check.holes() == [(1, 4), (6, 4)]
    assert check.lost() == 8


@blocks
def test_records_beyond_the_profile(block: int) -> None:
    """They are flagged, and are no substitute for lost ones."""
    flags, check = checked([0, 1, 3, 4, 5, 6], block, expected=5)
    assert flags == [GOOD, GOOD, GOOD, GOOD, BEYOND, BEYOND]
    assert check.lost() == 1
    assert check.holes() == [(2, 1)]


@blocks
def test_a_counter_that_restarts(block: int) -> None:
    """From 0 again in mid-record with stamps going on: pulses that have occurred, with stamps that are
    wrong."""
    pulses = [*range(400), *range(600)]
    times = stamps(np.arange(1000))
    flags, check = checked(pulses, max(block, 200), time_us=times)
    assert flags[:400] == [GOOD] * 400
    assert all(flag & (REPEATED | BAD) for flag in flags[400:800])
    assert check.highest <= 599


@pytest.mark.parametrize("block", [500, 1000])
@pytest.mark.parametrize("at", [0, 1, 250, 498, 499])
@pytest.mark.parametrize("off_us", [60_000, -80_000, 2**40, -(2**40)])
def test_a_stamp_that_cannot_be_right(block: int, at: int, off_us: int) -> None:
    """Tolerance: 50 ms or 8 pulses (62.5 ms at 128 Hz); 60 ms pass there, more does not."""
    pulses = np.arange(1000)
    times = stamps(pulses)
    times[at] += off_us
    flags, _ = checked(pulses.tolist(), block, time_us=times)
    expected = [GOOD] * 1000
    if abs(off_us) > 62_500:
        expected[at] = BAD
    assert flags == expected


def test_a_pulse_number_that_cannot_be_right_does_not_open_a_hole() -> None:
    """One record whose number is garbage (its stamp then disagrees) must not make millions of others lost."""
    pulses = np.arange(1000)
    pulses[300] = 4_000_000_000
    times = stamps(np.arange(1000))
    flags, check = checked(pulses.tolist(), 500, expected=1000, time_us=times)
    assert flags == [GOOD] * 300 + [BAD] + [GOOD] * 699
    assert check.lost() == 1
    assert check.holes() == [(300, 1)]


def test_a_clock_that_runs_fast_is_not_a_bad_stamp() -> None:
    """100 ppm over 6000 s are 0.6 s in all, but a ten-millionth from neighbour to neighbour."""
    pulses = np.arange(768_000)
    times = np.rint(pulses / RATE_HZ * 1e6 * (1 + 1e-4)).astype(np.int64)
    check = SequenceCheck(RATE_HZ, 768_000)
    for start in range(0, pulses.size, 65_536):
        part = slice(start, start + 65_536)
        assert not check.flags(times[part], pulses[part]).any()
    assert check.lost() == 0


# ---------------------------------------------------------------------------- record by record


def naive(pulses: list[int], expected: int) -> tuple[list[int], int, set[int]]:
    """Flags, number lost and which are lost: the contract's words, one record after another."""
    seen: set[int] = set()
    highest = -1
    flags = []
    for pulse in pulses:
        flag = BEYOND if pulse >= expected else GOOD
        if pulse in seen:
            flag |= REPEATED
        elif pulse < highest:
            flag |= LATE
        seen.add(pulse)
        highest = max(highest, pulse)
        flags.append(flag)
    lost = set(range(expected)) - seen
    return flags, len(lost), lost


@st.composite
def disturbed(draw: st.DrawFn) -> list[int]:
    """0, 1, 2, ... with records lost, repeated, exchanged and moved."""
    pulses = list(range(draw(st.integers(1, 40))))
    for _ in range(draw(st.integers(0, 8))):
        at = draw(st.integers(0, len(pulses) - 1))
        what = draw(st.sampled_from(("lose", "repeat", "move", "again")))
        if what == "lose" and len(pulses) > 1:
            del pulses[at]
        elif what == "repeat":
            pulses.insert(at, pulses[at])
        elif what == "move":
            pulses.insert(draw(st.integers(0, len(pulses) - 1)), pulses.pop(at))
        else:
            pulses.append(pulses[at])
    return pulses


@settings(max_examples=400, deadline=None)
@given(pulses=disturbed(), block=st.integers(1, 50), expected=st.integers(1, 45))
@example(pulses=[0, 3, 1, 1, 5, 4, 1, 2], block=3, expected=6)
@example(pulses=[5, 0], block=1, expected=6)
def test_against_the_naive_model(pulses: list[int], block: int, expected: int) -> None:
    flags, check = checked(pulses, block, expected)
    wanted, lost, missing = naive(pulses, expected)
    assert flags == wanted
    assert check.lost() == lost
    in_holes = {first + k for first, count in check.holes() for k in range(count)}
    assert {pulse for pulse in in_holes if pulse < expected} == missing

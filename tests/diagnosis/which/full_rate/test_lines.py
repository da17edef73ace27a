"""Lines, found once each and taken out of the samples: streams made here, of cosines and white noise."""

from __future__ import annotations

import numpy as np
import pytest
from line_streams import FOUR, NOISE, RATE, Facts, N, quiet, wave
from numpy.typing import NDArray

from fogreduce.diagnosis.which.full_rate.line import Line
from fogreduce.diagnosis.which.full_rate.lines import without_lines


def search(streams: list[NDArray[np.float64]], axes: NDArray[np.float64] = FOUR) -> tuple[list, list[Line]]:
    facts = [Facts(f"r{k}", axes) for k in range(len(streams))]
    left, lines = without_lines(streams, facts)  # type: ignore[arg-type]
    return left, [line for line in lines if line.taken]


@pytest.mark.parametrize("deg_h", [0.8, 2.74, 60.0, 2000.0])
@pytest.mark.parametrize("locked", [False, True])
def test_a_line_is_named_once_whatever_its_strength(deg_h: float, locked: bool) -> None:
    streams = quiet(1)
    for r, one in enumerate(streams):
        one[1] += wave(deg_h, 17.3, 0.7 if locked else 0.7 + 2.0 * r)
    left, (line,) = search(streams)
    assert line.channels == ("gyro2",)
    assert abs(line.hz - 17.3) < 3.0 * line.hz_std
    # of an amplitude: sqrt(2 / samples) of the noise
    assert line.std == pytest.approx(NOISE * np.sqrt(1.0 / N), rel=0.15)
    assert abs(line.deg_h - deg_h) < 3.5 * line.std
    for one in left:
        assert np.std(one[1]) == pytest.approx(NOISE, rel=0.03)


def test_a_motion_is_one_line_of_all_gyros() -> None:
    streams, axis = quiet(2), np.array([0.3, 0.5, 0.8]) / np.sqrt(0.98)
    for r, one in enumerate(streams):
        one += (FOUR @ axis)[:, None] * wave(60.0, 6.97, 1.0 + r)
    _, (line,) = search(streams)
    assert line.channels == ("table",)
    assert line.deg_h == pytest.approx(60.0, abs=4.0 * line.std)
    assert np.abs(np.array(line.axis) @ axis) > 0.9999


@pytest.mark.parametrize("moved", [False, True])
def test_a_line_that_runs_of_two_rates_show_is_named_once(moved: bool) -> None:
    rng, axis = np.random.default_rng(7), np.array([0.3, 0.5, 0.8]) / np.sqrt(0.98)
    facts = [Facts("r1", FOUR, 100.0), Facts("r2", FOUR, 64.0)]
    streams = [NOISE * rng.standard_normal((4, N)) for _ in facts]
    for stream, rate in zip(streams, (100.0, 64.0), strict=True):
        swing = 3.0 * np.sin(2.0 * np.pi * 9.11 / rate * np.arange(N))
        stream += (FOUR @ axis)[:, None] * swing if moved else np.eye(4)[:, 1:2] * swing
    _, lines = without_lines(streams, facts)  # type: ignore[arg-type]
    (one,) = [line for line in lines if line.taken]
    assert one.runs == ("*",)
    assert one.channels == (("table",) if moved else ("gyro2",))
    assert abs(one.hz - 9.11) < 3.0 * one.hz_std
    assert abs(one.deg_h - 3.0) < 3.5 * one.std
    if one.axis is not None:
        assert abs(np.array(one.axis) @ axis) > 0.999


def test_lines_of_one_frequency_that_no_motion_makes() -> None:
    streams = quiet(3)
    for r, one in enumerate(streams):
        for i, phase in ((0, 0.0), (2, 1.6)):
            one[i] += wave(30.0, 50.0 - 20.6, phase + r)
    _, lines = search(streams)
    assert sorted(line.channels for line in lines) == [("gyro1",), ("gyro3",)]


def test_a_line_that_wanders_is_one_line() -> None:
    """Its amplitude by 3 %, its phase by half a radian, over a run, and far above the noise."""
    streams, t = quiet(4), np.linspace(0.0, 1.0, N)
    for r, one in enumerate(streams):
        swing = 1.0 + 0.03 * np.sqrt(2.0) * np.sin(2.0 * np.pi * 1.7 * t + r)
        turn = 2.0 * np.pi * 17.3 / RATE * np.arange(N) + 0.5 * t**2 + r
        one[1] += 400.0 * swing * np.sin(turn)
    _, (line,) = search(streams)
    assert line.deg_h == pytest.approx(400.0, rel=0.02)


def test_noise_of_a_colour_has_no_lines() -> None:
    """Of a walk, of a filter of 30 ms, and white: none of them has a line in it."""
    rng = np.random.default_rng(5)
    one = NOISE * rng.standard_normal((4, N))
    one[0] += np.cumsum(rng.standard_normal(N))
    for k in range(1, N):
        one[1, k] = 0.72 * one[1, k - 1] + 0.28 * one[1, k]
    assert search([one])[1] == []


def test_a_rotation_s_curvature_is_no_line() -> None:
    """15 deg/h of Earth's rate seen from a table at 25 deg/s: a period of 14.4 s."""
    streams = quiet(6)
    for one in streams:
        one += 15.0 * np.cos(2.0 * np.pi / 14.4 / RATE * np.arange(N))
    assert search(streams)[1] == []


def test_missing_samples_are_no_noise_of_a_strong_line() -> None:
    (one,) = quiet(7, runs=1)
    one[1] += wave(2000.0, 17.3)
    one[1, np.random.default_rng(8).random(N) < 0.01] = np.nan
    (left,), (line,) = search([one])
    assert line.deg_h == pytest.approx(2000.0, abs=4.0 * line.std)
    assert np.nanstd(left[1]) == pytest.approx(NOISE, rel=0.03)

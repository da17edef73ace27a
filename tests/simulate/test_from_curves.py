"""A capture from published curves: Table 4's, as bundled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fogreduce.metadata.curves import Curves
from fogreduce.simulate.from_curves import blocks_from_curves, curve_volts, quiet_sigma
from fogreduce.simulate.plan import Options, prepare

ROOT = Path(__file__).parents[2]
MISSING = -(2**31)


@pytest.fixture(scope="module")
def made() -> tuple[Curves, np.ndarray, np.ndarray]:
    """Curves, volts with spurious and missing ones as NaN, counts."""
    plan = prepare(ROOT / "campaigns" / "published", ROOT / "calibrations", Options())
    assert plan.curves is not None
    facts = plan.facts("x-one-turn")
    counts = np.concatenate([b.counts for b in blocks_from_curves(plan.curves, facts)], axis=1)
    volts = counts * 1e-7
    volts[np.abs(volts) > 0.01] = np.nan  # the curves stay below 5 mV; a spurious count reaches 107 V
    return plan.curves, volts, counts


def test_the_curve_is_equation_7() -> None:
    """a + b sin(d) at t = 0, by the digits of Table 4: gyro 1, 3.0145608885e-3 + 2.4941e-4 sin(4.7153)."""
    curves = Curves.from_yaml(ROOT / "campaigns" / "published" / "curves.yaml")
    assert curve_volts(curves, np.zeros(1))[0, 0] == pytest.approx(2.76514845e-3, abs=1e-10)


def test_noise_over_the_whole_record_is_what_table_4_implies(
    made: tuple[Curves, np.ndarray, np.ndarray],
) -> None:
    """33.4, 25.3, 29.6, 30.6 microvolts, unstable interval included (768 000 samples: 0.1 %)."""
    curves, volts, _ = made
    residual = volts - curve_volts(curves, np.arange(volts.shape[1]) / 128.0)
    assert np.nanstd(residual, axis=1) == pytest.approx([33.4e-6, 25.3e-6, 29.6e-6, 30.6e-6], rel=0.005)
    assert np.abs(np.nanmean(residual, axis=1)).max() < 5 * 33.4e-6 / np.sqrt(768_000)


def test_unstable_from_5600_to_5800_s_on_gyros_1_to_3(made: tuple[Curves, np.ndarray, np.ndarray]) -> None:
    """Twice the noise in it: with 200 s of 6000 s, the quiet part's is sigma / sqrt(1 + 3 / 30)."""
    curves, volts, _ = made
    residual = volts - curve_volts(curves, np.arange(volts.shape[1]) / 128.0)
    inside = slice(5600 * 128, 5800 * 128)
    ratio = np.nanstd(residual[:, inside], axis=1) / np.nanstd(residual[:, : 5600 * 128], axis=1)
    assert ratio == pytest.approx([2.0, 2.0, 2.0, 1.0], rel=0.02)
    assert quiet_sigma(curves, 6000.0)[0] == pytest.approx(33.4e-6 / np.sqrt(1.1), rel=1e-12)


def test_missing_and_spurious(made: tuple[Curves, np.ndarray, np.ndarray]) -> None:
    """1e-4 and 1e-5 of 3 072 000 counts: 307 and 31 expected; 5 standard deviations."""
    _, _, counts = made
    assert abs((counts == MISSING).sum() - 307) < 5 * np.sqrt(307)
    spurious = (np.abs(counts.astype(np.int64)) > 100_000) & (counts != MISSING)
    assert 31 - 5 * np.sqrt(31) < spurious.sum() < 31 + 5 * np.sqrt(31)


def test_without_noise_only_rounding_is_left() -> None:
    plan = prepare(ROOT / "campaigns" / "published", ROOT / "calibrations", Options(noise=False))
    assert plan.curves is not None
    block = next(iter(blocks_from_curves(plan.curves, plan.facts("x-one-turn"), noise=False)))
    exact = curve_volts(plan.curves, block.pulse / 128.0)
    assert np.abs(block.counts * 1e-7 - exact).max() <= 0.5000001e-7

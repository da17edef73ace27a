"""The bench beside captures that an independent simulator made from the same contract.

They are not part of the repository; without them these tests are skipped.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from withheld.chain.campaign import read_campaign
from withheld.chain.capture_file import read_capture
from withheld.chain.injector import exact_world, realistic_world, run_bytes, run_counts
from withheld.chain.temperature import Temperature
from withheld.clairvoyant.blocks import block_count, difference, metric
from withheld.clairvoyant.separation import snr
from withheld.effects.entry import entry_from

PRACTICE = Path(__file__).resolve().parents[3] / "shared" / "practice"
pytestmark = pytest.mark.skipif(not PRACTICE.is_dir(), reason=f"no practice captures at {PRACTICE}")
NAMES = [f"practice-{k}" for k in range(1, 6)]


@pytest.fixture(scope="module")
def campaigns():
    return {name: read_campaign(PRACTICE / "campaigns" / name, PRACTICE / "calibrations") for name in NAMES}


def capture_path(name, run):
    return PRACTICE / "campaigns" / name / "runs" / run.run_id / "capture.fogcap"


def decoded(unit, run, counts):
    """Rates [deg/h] of counts."""
    volts = counts * run.volts_per_count * np.array(run.polarity)
    return (volts - np.array(unit.bias)) / np.array(unit.scale_factor) * 3600.0


@pytest.mark.parametrize("name", NAMES)
def test_format_to_the_byte_layout(campaigns, name):
    """Header, length, stamps and pulse numbers are ours to the byte; the counts hold noise."""
    of = campaigns[name]
    world = realistic_world(of, (), 1)
    for run in of.runs[:2]:
        theirs, ours = capture_path(name, run).read_bytes(), run_bytes(world, run)
        assert theirs[:64] == ours[:64]
        assert len(theirs) == len(ours)
        width = 12 + 4 * of.unit.n
        a, b = (np.frombuffer(c[64:], dtype=np.uint8).reshape(-1, width)[:, :12] for c in (theirs, ours))
        assert (a == b).all()


def test_white_noise_agrees(campaigns):
    """Differences of neighbouring samples: theirs over ours, 4 gyros and 8 runs of 38,400 samples."""
    of = campaigns["practice-1"]
    world = realistic_world(of, (), 2, noise_level_rel=0.0)
    theirs = np.array(
        [np.diff(read_capture(capture_path("practice-1", r)).counts, axis=0).var(axis=0) for r in of.runs]
    )
    ours = np.array([np.diff(run_counts(world, r)[1], axis=0).var(axis=0) for r in of.runs])
    # 8 * 38400 differences, neighbours correlated by -1/2: relative error sqrt(3 / 307200) = 0.3 %
    assert theirs.mean(axis=0) / ours.mean(axis=0) == pytest.approx(1.0, abs=5 * 0.003 * np.sqrt(2))


def block_residuals(of, name):
    """Their block means less our prediction from metadata alone, run by run, (blocks, n) [deg/h]."""
    world, rows = exact_world(of), []
    for run in of.runs:
        blocks, length = block_count(run)
        per = int(length * run.sample_rate_hz)
        theirs = decoded(of.unit, run, read_capture(capture_path(name, run)).counts)
        ours = decoded(of.unit, run, run_counts(world, run)[1])
        rows.append((theirs - ours)[: blocks * per].reshape(blocks, per, -1).mean(axis=1))
    return rows


def p_value(of, name):
    inner = metric(exact_world(of))
    white = inner.white(block_residuals(of, name))
    return float(chi2.sf(inner.gram(white[:, None], white[:, None])[0, 0], len(white)))


def test_their_run_with_nothing_wrong_fits_our_prediction_and_our_covariance(campaigns):
    """One chi-square over 9,600 block means, noise and stated uncertainties in its covariance."""
    assert 1e-3 < p_value(campaigns["practice-1"], "practice-1") < 1 - 1e-3


def logged(of, name):
    """A world without noise whose temperatures are the logs'."""
    heat = {}
    for run in of.runs:
        log = PRACTICE / "campaigns" / name / "runs" / run.run_id / "temperature.csv"
        time, electronics, sensor = np.loadtxt(log, delimiter=",", skiprows=1).T
        heat[run.run_id] = Temperature(time, electronics, sensor, sensor)
    return replace(exact_world(of), heat=heat)


@pytest.mark.parametrize("name", ["practice-2", "practice-3"])
def test_their_effects_are_ours(campaigns, name):
    """The answer's effect, by our arithmetic and with its parameters, is what their captures hold: 1 of it.

    The best multiple of it has the standard deviation 1 / SNR.
    """
    of = campaigns[name]
    entries = tuple(entry_from(one) for one in json.loads((PRACTICE / "answers.json").read_text())[name])
    world = logged(of, name)
    inner = metric(world)
    data, model = inner.white(block_residuals(of, name)), inner.white(difference(world, entries))
    size = snr(inner, model)
    assert size > 5.0
    multiple = float(inner.gram(data[:, None], model[:, None])[0, 0]) / size**2
    assert multiple == pytest.approx(1.0, abs=4.0 / size)
    left = data - model
    assert 1e-3 < float(chi2.sf(inner.gram(left[:, None], left[:, None])[0, 0], len(left))) < 1 - 1e-3


def test_their_telegraph_is_not_noise(campaigns):
    assert p_value(campaigns["practice-5"], "practice-5") < 1e-6


def test_low_frequencies_agree(campaigns):
    """Slow noise: the spread of eighths of a run about its mean, theirs within the range of ours."""
    of = campaigns["practice-1"]

    def spread(rows):
        parts = [row[: len(row) // 8 * 8].reshape(8, -1, row.shape[1]).mean(axis=1) for row in rows]
        return np.mean([np.var(part, axis=0) for part in parts])

    ours = []
    for seed in range(6):
        world, nominal, rows = realistic_world(of, (), seed), exact_world(of), []
        for run in of.runs[-2:]:  # slow and still: uncertainties that turn with the table stay small
            rate = [decoded(of.unit, run, run_counts(w, run)[1]) for w in (world, nominal)]
            rows.append((rate[0] - rate[1]).reshape(300, -1, of.unit.n).mean(axis=1))
        ours.append(spread(rows))
    theirs = spread(block_residuals(of, "practice-1")[-2:])
    # 2 runs x 4 gyros x 7 degrees of freedom: a relative error of sqrt(2 / 56) = 19 %
    assert theirs == pytest.approx(np.mean(ours), rel=4 * 0.19)

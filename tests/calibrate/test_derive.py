"""Derivations of simulated campaigns against what was put into them."""

from __future__ import annotations

import numpy as np
import pytest
from calibration_bench import drawn_in, errors

from fogreduce.calibrate.coefficients import Coefficients
from fogreduce.calibrate.derive import derive
from fogreduce.errors import BadInput


def entry(effect, gyro, **parameters):
    return {"effect": effect, "channels": [f"gyro{gyro}"], "runs": ["*"], "parameters": parameters}


def test_what_was_put_in_comes_back(bench) -> None:
    """A bias offset, a scale factor error and a tipped axis, each of another gyro, with noise."""
    effects = [
        entry("bias_offset", 1, deg_h=4.0),
        entry("scale_factor_error", 2, ppm=900.0),
        entry("axis_misalignment", 4, mrad=[0.0, 2.0, 0.0]),  # gyro 4's axis is x: all of it is across
    ]
    found = derive(bench.simulate(effects), bench.calibrations)
    facts, parameters = found.readings[0].facts, found.parameters
    errors = parameters.standard_errors
    lengths = np.linalg.norm(facts.axes, axis=1)  # the record's H is rounded: its axes are not of length 1
    bias = facts.bias / facts.scale_factor / lengths * 3600
    assert not found.undetermined
    assert parameters.bias_deg_h[0] - bias[0] == pytest.approx(4.0, abs=4 * errors[0, 0])
    assert errors[0, 0] < 0.5
    assert (parameters.scale_ratio[1] / lengths[1] - 1) * 1e6 == pytest.approx(900.0, abs=4e6 * errors[1, 1])
    assert errors[1, 1] < 2e-5
    tipped = parameters.axes[3] - facts.axes[3] / lengths[3]
    assert tipped[1] * 1e3 == pytest.approx(2.0 / lengths[3], abs=0.05)
    # What was not touched stays where it was.
    assert abs(parameters.scale_ratio[0] / lengths[0] - 1) < 4 * errors[0, 1]
    assert found.solution.chi2 / found.solution.freedom == pytest.approx(1.0, abs=0.15)


def test_white_noise_is_that_of_the_samples_and_of_bins_where_it_is_not_white(bench) -> None:
    """Known to the part in a hundred that so many samples allow: a diagnosis sees less than one of bins."""
    found = derive(bench.simulate(), bench.calibrations)
    samples = 7 * 72 * 16
    for noise in found.noise:
        assert noise.white_deg_sqrt_h == pytest.approx(0.002, rel=4 * np.sqrt(3 / samples) / 2)
    # A low pass takes most of the steps from sample to sample away, and little of the bins' noise.
    effect = {
        "effect": "low_pass",
        "channels": ["*"],
        "runs": ["*"],
        "parameters": {"time_constant_ms": 100.0},
    }
    filtered = derive(bench.simulate([effect]), bench.calibrations)
    assert filtered.noise[0].white_deg_sqrt_h == pytest.approx(0.002, rel=0.25)


def test_a_temperature_or_nonlinearity_is_a_departure_and_not_a_scale_factor(bench) -> None:
    effects = [entry("scale_factor_asymmetry", 2, ppm=300.0)]
    found = derive(bench.simulate(effects), bench.calibrations)
    asymmetry = {one.gyro: one for one in found.shapes if one.name == "asymmetry"}
    assert asymmetry[1].value == pytest.approx(300.0, abs=4 * asymmetry[1].std + 3)
    assert abs(asymmetry[0].value) < 5 * asymmetry[0].std + 1
    assert not [one for one in found.shapes if one.name.startswith("temperature")]  # there is no log


def test_one_sense_about_one_axis_leaves_bias_and_scale_factor_together(bench) -> None:
    campaign = bench.simulate(runs=["1-xp"])
    found = derive(campaign, bench.calibrations)
    words = [one.words for one in found.undetermined]
    assert any("gyro1's bias" in text and "gyro1's scale factor" in text for text in words)
    assert found.next_run is not None
    assert found.next_run["table"]["axis"] in "xyz"


def test_one_axis_leaves_the_others_open_and_a_run_about_one_of_them_helps(bench) -> None:
    """Gyro 4 looks along the table's axis: its scale factor is right, where its axis points is open."""
    runs = ["1-xp", "2-xm", "7-st"]
    found = derive(bench.simulate([entry("scale_factor_error", 4, ppm=900.0)], runs=runs), bench.calibrations)
    words = " / ".join(one.words for one in found.undetermined)
    assert "gyro4's axis towards" in words
    assert "gyro1's scale factor and gyro1's axis" in words
    assert "gyro4's scale factor" not in words
    assert "bias" not in words
    errors = found.parameters.standard_errors[3]
    length = np.linalg.norm(found.readings[0].facts.axes[3])
    ppm = (found.parameters.scale_ratio[3] / length - 1) * 1e6
    assert ppm == pytest.approx(900.0, abs=4e6 * errors[1])
    assert errors[1] < 2e-5
    assert found.next_run is not None
    assert found.next_run["table"]["axis"] in "yz"
    assert {step["rate_deg_s"] for step in found.next_run["table"]["profile"]} == {10.0, -10.0, 0.0}


def test_one_axis_both_senses_without_a_standstill_needs_none(bench) -> None:
    """Both senses give the biases; across the axis stays open what no turn is about."""
    found = derive(bench.simulate(runs=["1-xp", "2-xm"]), bench.calibrations)
    words = " / ".join(one.words for one in found.undetermined)
    assert "bias" not in words
    assert "gyro4's scale factor" not in words
    assert "gyro4's axis towards" in words
    for gyro in (1, 2, 3):
        assert f"gyro{gyro}'s scale factor" in words
    assert found.next_run is not None
    assert found.next_run["table"]["axis"] in "yz"


def test_two_axes_in_one_sense_leave_two_directions_of_each_gyro_open(bench) -> None:
    """Of a gyro two readings, b + 10 k_x and b + 10 k_y: open are k_z, and b with both others.

    Gyro 3's axis lies across [1, 1, 0]: its bias goes with where the axis points, not with its length.
    """
    found = derive(bench.simulate(runs=["1-xp", "3-yp"]), bench.calibrations)
    for gyro in (1, 2, 3, 4):
        of_gyro = [one for one in found.undetermined if f"gyro{gyro}'s" in one.words]
        assert sum(one.directions for one in of_gyro) == 2
        with_bias = next(one for one in of_gyro if f"gyro{gyro}'s bias" in one.words)
        assert (f"gyro{gyro}'s scale factor" in with_bias.words) == (gyro != 3)
    assert (found.parameters.standard_errors[:, 0] > 10.0).all()  # nothing is taken from nowhere
    assert found.next_run is not None
    assert found.next_run["table"]["axis"] == "z"
    assert {step["rate_deg_s"] for step in found.next_run["table"]["profile"]} == {10.0, -10.0, 0.0}


def test_one_sense_leaves_bias_with_scale_factor_and_a_standstill_tells_them_apart(bench) -> None:
    turns = ["1-xp", "3-yp", "5-zp"]
    found = derive(bench.simulate(runs=turns), bench.calibrations)
    assert len(found.undetermined) == 4
    for gyro, one in enumerate(found.undetermined, start=1):
        assert one.words.startswith(f"gyro{gyro}'s bias, gyro{gyro}'s scale factor")
        assert one.directions == 1
    assert found.next_run is not None
    assert [step["rate_deg_s"] for step in found.next_run["table"]["profile"]] == [0.0]
    assert not derive(bench.simulate(runs=[*turns, "7-st"]), bench.calibrations).undetermined


def test_both_senses_need_no_standstill(bench) -> None:
    turns = ["1-xp", "2-xm", "3-yp", "4-ym", "5-zp", "6-zm"]
    found = derive(bench.simulate([entry("bias_offset", 2, deg_h=3.0)], runs=turns), bench.calibrations)
    assert not found.undetermined
    facts = found.readings[0].facts
    bias = facts.bias[1] / facts.scale_factor[1] / np.linalg.norm(facts.axes[1]) * 3600
    error = found.parameters.standard_errors[1, 0]
    assert found.parameters.bias_deg_h[1] - bias == pytest.approx(3.0, abs=4 * error)
    assert error < 0.3


def test_residuals_show_a_cubic_scale_factor_and_its_polynomial_takes_it_away(bench) -> None:
    effects = [entry("scale_factor_nonlinearity", 2, ppm_at_10_deg_s=60.0)]
    runs = ["x-steps", "y-steps", "z-steps"]
    found = derive(bench.simulate(effects, runs=runs), bench.calibrations)

    def chi2(residuals, gyro):
        return np.mean([(one.deg_h / one.std_deg_h) ** 2 for one in residuals if one.gyro == gyro])

    assert chi2(found.by_rate, 1) > 100
    assert chi2(found.by_rate_polynomial, 1) < 3
    assert chi2(found.by_rate, 3) < 3
    rates = [one.rate_deg_s for one in found.by_rate if one.gyro == 3]
    assert rates == sorted(rates)
    assert rates[0] == pytest.approx(-30.0, rel=1e-3)  # gyro 4's axis is x
    left = np.array([one.deg_h / one.std_deg_h for one in found.residuals])
    assert np.sqrt(np.mean(left[[one.gyro == 3 for one in found.residuals]] ** 2)) < 1.5


def test_a_standstill_alone_leaves_every_scale_factor_open(bench) -> None:
    found = derive(bench.simulate(runs=["7-st"]), bench.calibrations)
    for gyro in range(1, 5):
        assert any(f"gyro{gyro}'s scale factor" in one.words for one in found.undetermined)
    # Not a number is taken from nowhere: an open direction keeps its ignorance.
    assert (found.parameters.standard_errors[:, 1] > 0.01).all()


def test_turn_on_scatter_is_found_apart_from_noise(bench) -> None:
    """3 deg/h from run to run where the record states 0.1; the same in both senses, so no scale factor."""
    runs = ["1-xp", "2-xm", "3-yp", "4-ym", "5-zp", "6-zm", "7-st"]
    sizes = [3.0, 3.0, -3.0, -3.0, 2.0, 2.0, -2.0]
    effects = [
        entry("turn_on_bias", 4, deg_h=size) | {"runs": [run]} for run, size in zip(runs, sizes, strict=True)
    ]
    found = derive(bench.simulate(effects), bench.calibrations)
    assert 1.0 < found.solution.turn_on_deg_h[3] < 6.0
    assert found.solution.turn_on_deg_h[0] < 0.6
    sizes_found = {one.run: one.deg_h for one in found.turn_on if one.gyro == 3}
    assert sizes_found[0] - sizes_found[2] == pytest.approx(6.0, abs=1.0)


def test_pulls_are_standard_normal(bench) -> None:
    """Stated uncertainties drawn: over 6 campaigns of four gyros the root mean square pull is near 1."""
    squares: list[float] = []
    for seed in range(6):
        campaign = bench.simulate(options=["--draw-uncertainties", "--seed", str(seed)])
        found = derive(campaign, bench.calibrations)
        pulls = errors(found, drawn_in(campaign)) / np.sqrt(np.diag(found.parameters.covariance))
        squares += list((pulls.reshape(-1, 4)[:, 1:] ** 2).ravel())
    # 72 squares, the common table rate correlating the scale factors: loose enough for chance, not for 2.
    assert 0.5 < np.mean(squares) < 1.8


def test_runs_of_two_records_are_refused(bench) -> None:
    campaign = bench.simulate(runs=["1-xp", "2-xm"])
    text = (bench.calibrations / "UNIT" / "a.yaml").read_text().replace("version: a", "version: b")
    (bench.calibrations / "UNIT" / "b.yaml").write_text(text)
    path = campaign / "runs" / "2-xm" / "run.yaml"
    path.write_text(path.read_text().replace("UNIT@a", "UNIT@b"))
    with pytest.raises(BadInput, match=r"runs of UNIT@a \(1-xp\) and of UNIT@b \(2-xm\)"):
        derive(campaign, bench.calibrations)


def test_practice_campaigns_agree_with_their_record(shared) -> None:
    """Campaigns of another simulator, drawn about the record: every change within both errors."""
    practice = shared / "practice"
    for name in ("practice-1", "practice-2", "practice-4"):
        found = derive(practice / "campaigns" / name, practice / "calibrations")
        assert not found.undetermined
        present, parameters = Coefficients.of(found.readings[0].record), found.parameters
        errors = parameters.standard_errors
        scale = found.readings[0].facts.scale_factor * parameters.scale_ratio
        tipped = np.einsum("nij,nj->ni", parameters.across, parameters.axes - present.axes)
        # A bias is known as the record states it, and as the turn-on scatter lets eight runs show it.
        changes = {
            "bias": ((parameters.bias_deg_h - present.bias_deg_h), errors[:, 0], present.bias_std_deg_h),
            "scale factor": (scale / present.scale_factor - 1, errors[:, 1], present.scale_factor_std_rel),
            "axis, first": (tipped[:, 0], errors[:, 2], present.axis_std_rad),
            "axis, second": (tipped[:, 1], errors[:, 3], present.axis_std_rad),
        }
        for what, (change, std, stated) in changes.items():
            assert np.abs(change / np.hypot(std, stated)).max() < 3.5, (name, what)

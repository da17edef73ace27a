"""Part files: what a data sheet fills in, and what it leaves alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from fogreduce.errors import BadInput
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.part import BUNDLED, Part

RECORD = {
    "schema": "fogreduce/calibration/1",
    "unit": "U",
    "version": "1",
    "valid_from": "2012-06-01T00:00:00Z",
    "procedure": "made up",
    "axes": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    "scale_factor_V_per_deg_s": [0.1, -0.2],
    "bias_V": [0.0, 0.0],
}
SHEET = {
    "schema": "fogreduce/part/1",
    "product": "P",
    "source": "S",
    "bias_repeatability_deg_h": {"value": 3.6, "meaning": "maximum"},
    "scale_factor_ppm": {"value": 50.0, "meaning": "one_sigma"},
    "angle_random_walk_deg_sqrt_h": {"value": 0.02, "meaning": "maximum"},
    "bias_instability_deg_h": {"value": 0.0664, "meaning": "allan_minimum"},
    "bandwidth_hz": 100.0,
}


def record(**more: object) -> CalibrationRecord:
    return CalibrationRecord.from_data({**RECORD, **more}, "1.yaml")


def part(**more: object) -> Part:
    return Part.from_data({**SHEET, **more}, "part.yaml")


def test_a_maximum_is_three_sigma_and_an_allan_minimum_is_flicker_over_its_factor() -> None:
    filled, assumed = part().filled(record())
    stated, noise = filled.stated_uncertainty, filled.stated_noise
    assert stated.turn_on_bias_deg_h == pytest.approx((1.2, 1.2))
    # 1.2 deg/h is 1.2 / 3600 deg/s, through C of either sign
    assert stated.bias == pytest.approx((1.2 / 3600 * 0.1, 1.2 / 3600 * 0.2))
    assert stated.scale_factor_rel == pytest.approx((50e-6, 50e-6))
    assert noise.angle_random_walk_deg_sqrt_h == (0.02, 0.02)
    assert noise.bias_instability_deg_h == pytest.approx((0.1, 0.1), rel=1e-3)  # IEEE 952: 0.664
    assert len(assumed) == 5
    assert all("data sheet of P" in one.said for one in assumed)


def test_what_the_record_states_stands_and_captures_speak_for_white_noise() -> None:
    own = record(uncertainty={"turn_on_bias_deg_h": [0.1, 0.2]}, noise={"bias_instability_deg_h": [0.5, 0.6]})
    filled, _ = part().filled(own, white_noise=False)
    assert filled.stated_uncertainty.turn_on_bias_deg_h == (0.1, 0.2)
    assert filled.stated_noise.bias_instability_deg_h == (0.5, 0.6)
    assert filled.noise is not None
    assert filled.noise.angle_random_walk_deg_sqrt_h is None
    silent = Part.from_data({k: SHEET[k] for k in ("schema", "product", "source")}, "part.yaml")
    assert silent.filled(own) == (own, [])


def test_sizes_that_units_of_the_class_show() -> None:
    shown = part().realistic()
    assert shown["scale_factor_ppm"] == pytest.approx((5.0, 150.0))
    assert shown["bandwidth_hz"] == pytest.approx((0.159, 4.77), rel=1e-2)  # 1 / (2 pi 100 Hz) = 1.59 ms
    assert "acceleration_deg_h_per_g" not in shown


@pytest.mark.parametrize("name", sorted(BUNDLED))
def test_bundled_parts_are_parts_with_their_source(name: str) -> None:
    one = Part.named(name)
    assert one.source
    assert one.angle_random_walk_deg_sqrt_h is not None


def test_bad_parts_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"--part: found nowhere; expected a part file, or one of mems"):
        Part.named("nowhere")
    with pytest.raises(BadInput, match=r"scale_factor_ppm\.meaning: found the text 'max'"):
        part(scale_factor_ppm={"value": 1.0, "meaning": "max"})

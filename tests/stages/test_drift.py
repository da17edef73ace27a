"""The paper's offset rule and its integral: Table 5, by hand, by quadrature."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from fogreduce.estimate.curve_terms import drift_terms
from fogreduce.estimate.mean_curve import curve
from fogreduce.stages.drift import accumulated_error, adjusted_curve, plain_integral

# Table 5 of the paper.
TABLE_5 = {
    "x": (6.2105507269056e-02, -2.4458719149183e-04, 1.9402958511762, 1.8026515727242e-07),
    "y": (-3.3612694209393e-03, 1.2949589133770e-04, -9.8994748030405e-01, 1.0205799414829e-07),
    "z": (4.1687152680458e-03, 1.2018215639015e-04, 4.7491196471456, -9.3555976012266e-08),
}
C_RAD_S = 0.001047197551197


def plain(theta: list[float], rate_rad_s: float, covariance: np.ndarray | None = None) -> dict:
    covariance = np.zeros((4, 4)) if covariance is None else covariance
    return {
        "theta": theta,
        "rate_rad_s": rate_rad_s,
        "has_slope": True,
        "covariance": covariance.tolist(),
        "coloured_covariance": None,
        "stated_covariance": None,
    }


@pytest.mark.parametrize(
    ("axis", "degrees", "drift"), [("x", 4.6133, 2.768), ("y", 2.4866, 1.492), ("z", -0.9634, -0.578)]
)
def test_table_5_leads_to_the_printed_drifts(axis: str, degrees: float, drift: float) -> None:
    """Integrating Table 5 over 6000 s (paper/README): 4.6133, 2.4866, -0.9634 deg, to the digits given."""
    a, b, d, e = TABLE_5[axis]
    item = plain([a, b * math.sin(d), b * math.cos(d), e], C_RAD_S)
    error = accumulated_error({"start_s": 0.0, "stop_s": 6000.0}, item).value
    assert error == pytest.approx(degrees, abs=5e-5)
    assert error * 3600 / 6000 == pytest.approx(drift, abs=5e-4)


@pytest.mark.parametrize(
    ("axis", "commanded", "rate_deg_h"), [("x", 0.06, 9.53), ("y", 0.0, -11.00), ("z", 0.0, 14.00)]
)
def test_table_5_integrated_as_it_stands(axis: str, commanded: float, rate_deg_h: float) -> None:
    """The plain integral less the commanded angle, an hour: a - commanded + e T / 2, the sine gone in a whole
    turn. By hand from Table 5: x 7.580 + 1.947, y -12.101 + 1.102, z 15.007 - 1.010 deg/h."""
    a, b, d, e = TABLE_5[axis]
    item = plain([a, b * math.sin(d), b * math.cos(d), e], C_RAD_S)
    angle = plain_integral({"start_s": 0.0, "stop_s": 6000.0}, item).value
    assert (angle - 6000.0 * commanded) * 3600 / 6000 == pytest.approx(rate_deg_h, abs=0.005)
    assert rate_deg_h == pytest.approx(3600 * (a - commanded + 3000.0 * e), abs=0.005)


def test_a_turn_by_hand_has_its_angle_in_the_plain_integral() -> None:
    """A half turn that starts and ends at rest: rate (1 - cos(2 pi t / T)) 180 deg / T.

    It turned 180 deg. The offset rule, made for turns at a constant rate, moves the start up to the commanded
    180 deg / T and finds 360."""
    duration = 60.0
    mean = 180.0 / duration
    item = plain([mean, -mean, 0.0, 0.0], 2 * math.pi / duration)
    segment = {"start_s": 0.0, "stop_s": duration}
    assert plain_integral(segment, item).value == pytest.approx(180.0, rel=1e-12)
    assert 180.0 + accumulated_error(segment, item).value == pytest.approx(360.0, rel=1e-12)


def test_a_straight_drift_by_hand() -> None:
    """e alone: over T it adds e T^2 / 2, and from a start at t0 the same, since the offset moves with it."""
    for start in (0.0, 500.0):
        item = plain([7.0, 0.0, 0.0, 1e-6], 0.0)
        error = accumulated_error({"start_s": start, "stop_s": start + 1000.0}, item).value
        assert error == pytest.approx(0.5, rel=1e-9)


def test_a_constant_offset_does_not_count() -> None:
    terms = drift_terms(100.0, 300.0, 0.01)
    assert terms[0] == 0.0


@pytest.mark.parametrize("start", [0.0, 1234.5])
@pytest.mark.parametrize("rate", [C_RAD_S, -0.17, 0.0])
def test_against_quadrature_of_the_adjusted_curve(start: float, rate: float) -> None:
    segment = {"start_s": start, "stop_s": start + 300.0}
    item = plain([0.0621, -2e-4 if rate else 0.0, 1e-4 if rate else 0.0, 1.8e-7], rate)
    commanded = 0.06
    error = accumulated_error(segment, item).value

    def left(t: float) -> float:
        return float(adjusted_curve(segment, item, commanded, np.array([t]))[0]) - commanded

    assert left(start) == pytest.approx(0.0, abs=1e-17)
    expected, _ = quad(left, start, start + 300.0, epsabs=1e-13, limit=500)
    assert error == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_its_error_is_the_scatter_of_what_is_drawn() -> None:
    """20 000 draws of theta from its covariance: scatter to 0.5 %, four of that."""
    generator = np.random.default_rng(1)
    root = generator.normal(size=(4, 4)) * np.array([[1e-6], [1e-6], [1e-6], [1e-9]])
    covariance = root @ root.T
    segment = {"start_s": 0.0, "stop_s": 6000.0}
    found = accumulated_error(segment, plain([0.0] * 4, C_RAD_S, covariance))
    assert math.isnan(found.coloured)
    draws = generator.multivariate_normal(np.zeros(4), covariance, 20_000, method="svd")
    errors = [accumulated_error(segment, plain(list(draw), C_RAD_S)).value for draw in draws]
    assert np.std(errors) == pytest.approx(found.white, rel=0.02)


def test_the_curve_of_the_module_is_the_papers(published) -> None:
    """Final angle = nominal + accumulated error, from the fit's own numbers by quadrature on a fine grid."""
    item = published.reduced.channel("x")
    theta = np.append(item["theta"], item["rate_rad_s"])
    time_s = np.linspace(0.0, 6000.0, 60_001)
    values = curve(time_s, theta) - curve(np.zeros(1), theta) + 0.06
    angle = np.sum((values[1:] + values[:-1]) / 2 * np.diff(time_s))
    row = published.reduced.row("drift", "x")
    assert float(row["final_angle_deg"]) == pytest.approx(angle, abs=1e-6)

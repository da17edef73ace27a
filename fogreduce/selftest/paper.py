"""The paper's tables: Table 5 integrated, and Table 4's run simulated and reduced by the whole chain."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fogreduce.python.reduce import reduce
from fogreduce.python.simulate import simulate
from fogreduce.selftest.check import Check, printed
from fogreduce.stages.drift import accumulated_error

if TYPE_CHECKING:
    import pandas as pd

DATA = Path(__file__).with_name("data")
#: The published unit's record, Tables 1 to 3.
RECORD = DATA / "calibrations" / "TETRA-01" / "2012a.yaml"
_RUN = "x-one-turn"
_DURATION_S = 6000.0
_RATE_RAD_S = 0.001047197551197

#: Table 5: a [deg/s], b [deg/s], d [rad], e [deg/s^2]; drift of the integral [deg/h], as the paper gives it.
_TABLE_5 = {
    "x": ((6.2105507269056e-02, -2.4458719149183e-04, 1.9402958511762, 1.8026515727242e-07), "2.768"),
    "y": ((-3.3612694209393e-03, 1.2949589133770e-04, -9.8994748030405e-01, 1.0205799414829e-07), "1.492"),
    "z": ((4.1687152680458e-03, 1.2018215639015e-04, 4.7491196471456, -9.3555976012266e-08), "-0.578"),
}
#: Table 4: values of gyros 1 to 4 and their printed standard errors, in volts.
_TABLE_4 = {
    "a_V": (
        (3.0145608885319e-03, -3.3202372735903e-03, 3.3255925499732e-03, 4.2030584689672e-03),
        (1.1216842846562e-07, 8.4787838609453e-08, 9.9391037526045e-08, 1.0255050681064e-07),
    ),
    "b_V": (
        (2.4941349978130e-04, 2.8105837834706e-04, 2.9499913608135e-04, 2.5720794013645e-05),
        (5.4013774969571e-08, 6.0722039251218e-08, 7.0212455993882e-08, 5.6635037554389e-08),
    ),
    "d_rad": (
        (4.7153004445657, 3.6211165526360, 2.6108358094789, -1.1046410170906),
        (3.4541462982546e-04, 1.6766451507779e-04, 1.9140672355502e-04, 2.8662216118657e-03),
    ),
    "e_V_s": (
        (-8.0924928027562e-10, -1.5720038834579e-08, 2.7528190375688e-09, 1.8418978744009e-08),
        (3.5123121114346e-11, 2.6549480710252e-11, 3.1122157085080e-11, 3.2111476669938e-11),
    ),
}
_DRIFT_DEG_H = {"x": 2.77, "y": 1.49, "z": -0.58}
_FINAL_DEG, _FINAL_TOLERANCE = 364.61, 0.02
_ERRORS = 4.0
_NOISE = f"{_ERRORS:g} standard errors: the noise is drawn anew"


def integrated() -> list[Check]:
    """Drift of Table 5's curves, by the offset rule."""
    checks = []
    for axis, ((a, b, d, e), text) in _TABLE_5.items():
        theta = [a, b * math.sin(d), b * math.cos(d), e]
        item = {"theta": theta, "rate_rad_s": _RATE_RAD_S, "covariance": [[0.0] * 4] * 4}
        item |= {"coloured_covariance": None, "stated_covariance": None, "has_slope": True}
        angle = accumulated_error({"start_s": 0.0, "stop_s": _DURATION_S}, item).value
        drift = angle * 3600.0 / _DURATION_S
        checks.append(
            printed("The paper's Table 5", f"drift of {axis}", "Table 5, integrated", text, drift, "deg/h")
        )
    return checks


def reconstructed(folder: Path) -> list[Check]:
    """The run made from Table 4's curves and noise, reduced: simulator, reduction and tables together."""
    campaign = simulate(DATA / "campaigns" / "published", DATA / "calibrations", folder / "published")
    found = reduce(campaign.out / "runs" / _RUN, DATA / "calibrations", folder / "results")
    gyros, axes = (_rows(found.table(name), key) for name, key in (("gyro_fit", "gyro"), ("drift", "axis")))
    return [*_parameters(gyros), *_drifts(axes)]


def _rows(table: pd.DataFrame, key: str) -> dict[str, dict[str, Any]]:
    """Rows by the name in one column."""
    return {str(row[key]): {str(name): row[name] for name in row} for row in table.to_dict("records")}


def _parameters(rows: dict[str, dict[str, Any]]) -> list[Check]:
    checks = []
    for parameter, (values, errors) in _TABLE_4.items():
        name, _, unit = parameter.partition("_")
        about = ("The paper's Table 4", f"{name} of gyro", "its standard error, gyro")
        shown = unit.replace("_s", "/s")
        for k, (value, error) in enumerate(zip(values, errors, strict=True), 1):
            row = rows[f"gyro{k}"]
            obtained, stated = float(row[parameter]), float(row[f"{name}_err_{unit}"])
            if parameter == "d_rad":  # the paper's phases are not brought to one turn
                obtained = value + math.remainder(obtained - value, 2.0 * math.pi)
            allowed, because = _ERRORS * error, "2 %: estimated from the noise"
            checks += [
                Check(about[0], f"{about[1]} {k}", "Table 4", value, obtained, allowed, _NOISE, shown),
                Check(about[0], f"{about[2]} {k}", "Table 4", error, stated, 0.02 * error, because, shown),
            ]
    return checks


def _drifts(rows: dict[str, dict[str, Any]]) -> list[Check]:
    group, source, checks = "The paper's drifts", "section IV", []
    for axis, value in _DRIFT_DEG_H.items():
        drift, error = (float(rows[axis][name]) for name in ("drift_deg_h", "drift_err_deg_h"))
        allowed, because = _ERRORS * error + 0.005, f"{_NOISE}, and its rounding"
        checks.append(Check(group, f"drift of {axis}", source, value, drift, allowed, because, "deg/h"))
    final = float(rows["x"]["final_angle_deg"])
    because = "0.005 of rounding, 0.006 of noise, twice and more"
    checks.append(
        Check(group, "final angle of x", source, _FINAL_DEG, final, _FINAL_TOLERANCE, because, "deg")
    )
    return checks

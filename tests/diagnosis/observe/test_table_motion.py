"""The table's encoder log: what the table did beside its command is no gap of the unit's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from bench_lab import RATES, RECORD, diagnosed, lab, simulated

from fogreduce.datasets.logs import TableLog
from fogreduce.diagnosis.observe.table_motion import table_motion
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.physics.table_motion import Profile

_RATE_HZ, _LEAST_COUNT = 64.0, 1e-7
#: Overshoot of a table that starts: a decaying swing of its angle [deg], as a servo's step response has it.
_SIZE_DEG, _DECAY_S, _TURN_HZ = 0.02, 3.0, 0.21


def swing(t: np.ndarray) -> np.ndarray:
    return _SIZE_DEG * np.exp(-t / _DECAY_S) * np.sin(2.0 * np.pi * _TURN_HZ * t)


def swing_rate(t: np.ndarray) -> np.ndarray:
    w = 2.0 * np.pi * _TURN_HZ
    return _SIZE_DEG * np.exp(-t / _DECAY_S) * (w * np.cos(w * t) - np.sin(w * t) / _DECAY_S)


def overshoot(campaign: Path, logged: bool, noise_deg: float = 2e-5) -> None:
    """Put the swing into the captures by their bytes, and into an encoder's log of ten rows a second."""
    axes = np.linalg.pinv(np.array(RECORD["H"]))
    gains = np.array(RECORD["scale_factor_V_per_deg_s"])
    generator = np.random.default_rng(4)
    for k, (axis, rate) in enumerate(zip("xxyyzx", RATES, strict=True)):
        sense = np.sign(rate)
        folder = campaign / "runs" / f"r{k}"
        path = folder / "capture.fogcap"
        raw = bytearray(path.read_bytes())
        records = np.frombuffer(raw, np.dtype([("t", "<u8"), ("p", "<u4"), ("c", "<i4", 4)]), offset=64)
        seen = axes[:, "xyz".index(axis)] * sense
        added = np.outer(swing_rate(records["p"] / _RATE_HZ), seen * gains / _LEAST_COUNT)
        records["c"][:] += np.rint(added).astype(np.int32)
        path.write_bytes(raw)
        if logged:
            t = np.arange(0.0, 120.05, 0.1)
            angle = 11.0 + rate * t + sense * swing(t) + noise_deg * generator.standard_normal(t.size)
            rows = "".join(f"{a:.1f},{b:.6f}\n" for a, b in zip(t, angle, strict=True))
            (folder / "table.csv").write_text("time_s,angle_deg\n" + rows)
            run = yaml.safe_load((folder / "run.yaml").read_text())
            (folder / "run.yaml").write_text(dump_yaml(run | {"table_log": "table.csv"}))


def test_an_overshoot_is_a_fault_of_the_table_unless_its_log_shows_it(tmp_path: Path) -> None:
    lab(tmp_path)
    blind, seen = (simulated(tmp_path, [], name) for name in ("blind", "seen"))
    overshoot(blind, logged=False)
    overshoot(seen, logged=True)
    without = diagnosed(tmp_path, blind)
    assert without["verdict"] in ("unexplained", "partly_explained")
    assert without["where"][0]["stage"] == "table"
    assert without["where"][0]["sigma"] > 20.0
    assert diagnosed(tmp_path, seen)["verdict"] == "no_gap"


PROFILE = Profile(np.array([10.0, 0.0, -10.0]), np.array([40.0, 20.0, 40.0]))
TIME = np.arange(0.0, 100.05, 0.1)


def log(angle_deg: np.ndarray, noise_deg: float = 1e-4) -> TableLog:
    return TableLog(TIME, angle_deg + noise_deg * np.random.default_rng(7).standard_normal(TIME.size))


def commanded(time: np.ndarray) -> np.ndarray:
    return np.degrees(PROFILE.angle_at(time.copy()))


@pytest.mark.parametrize(
    "angle",
    [
        commanded(TIME),
        commanded(TIME) * (1.0 + 2e-4),
        commanded(TIME - 0.37),
        -commanded(TIME),
        commanded(TIME) + np.degrees(1e-3 / 3.0) * np.sin(np.radians(3.0 * commanded(TIME))),
    ],
    ids=["as commanded", "rate error", "late start", "wrong sense", "ripple"],
)
def test_what_the_catalogue_names_is_left_to_be_named(angle: np.ndarray) -> None:
    assert table_motion(log(angle), PROFILE) is None


def test_a_spin_up_is_followed_within_the_logs_noise() -> None:
    """Constant acceleration over 4 s at each edge, by hand: the angle is a parabola there."""
    edges = [0.0, 4.0, 40.0, 44.0, 60.0, 64.0, 100.0]
    rate = np.interp(TIME, edges, [0.0, 10.0, 10.0, 0.0, 0.0, -10.0, -10.0])
    angle = np.concatenate(([0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(TIME))))
    found = table_motion(log(angle), PROFILE)
    assert found is not None
    off = np.degrees(found.departure.angle_at(TIME)) - (angle - commanded(TIME))
    assert np.max(np.abs(off - off[0])) < 6e-4
    still = (TIME > 50.0) & (TIME < 58.0)
    assert np.max(np.abs(found.departure.rate_at(TIME[still]))) < 1e-4
    quiet = (found.departure.time_s > 4.5) & (found.departure.time_s < 39.5)
    assert quiet.sum() < 3


def test_noise_of_the_size_of_a_step_of_the_encoder_is_no_motion() -> None:
    """Rounded readings have few values, and so has any median of them: it may be far off the noise."""
    still, time = Profile(np.array([0.0]), np.array([300.0])), np.arange(301.0)
    for seed in range(400):
        angle = np.round(np.random.default_rng(seed).normal(0.0, 1e-4, time.size), 4)
        assert table_motion(TableLog(time, angle), still) is None

"""What the physics needs to know of a run, as arrays: built from validated metadata, without pydantic.

A stage starts from the JSON that the manifest carries (already validated), so that it need not pay
for validation again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.physics.alignment import gyro_axes
from fogreduce.physics.earth_rate import EarthPart
from fogreduce.physics.frames import AXES, unit_from_enu
from fogreduce.physics.raw_quantity import INCREMENTS, RawUnit, RawUnitName, unit_of_capture
from fogreduce.physics.table_motion import Profile
from fogreduce.units import microseconds_since_1970

if TYPE_CHECKING:
    from fogreduce.metadata.calibration import CalibrationRecord
    from fogreduce.metadata.run import Run

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RunFacts:
    """A run and its calibration as numbers.

    Attributes
    ----------
    raw_unit : RawUnit
        Unit of the raw readings in use, from now on just "raw unit".
    captured_in : RawUnitName
        Unit of readings in the capture; of increments (`is_increment`) another than the one in use.
    capture_least_count : float
        What one count stands for, or the least step of a reading, as captured [captured_in].
    scale_factor, bias, polarity : (n,) arrays
        C [raw unit/(deg/s)], B [raw unit], +1 or -1.
    projection : (3, n) array or None
        H; None for a unit of one or two gyros, which gives no x, y, z.
    axes : (n, 3) array
        G, directions of the input axes in the unit frame.
    profile : Profile
        The commanded rates.
    table_axis : (3,) array
        Unit vector of the table's axis, unit frame.
    unit_from_enu : (3, 3) array
        u0.
    frame_signs : (3,) array
        The sign with which each projected axis reads a positive rotation.
    white_noise : (n,) array or None
        Stated angle random walk N [deg/sqrt(h)].
    bias_instability, rate_random_walk : (n,) arrays or None
        Stated B [deg/h] and K [deg/h/sqrt(h)].
    """

    run_id: str
    unit: str
    start_us: int
    sample_rate_hz: float
    raw_unit: RawUnit
    captured_in: RawUnitName
    capture_least_count: float
    latitude_deg: float
    scale_factor: Array
    bias: Array
    polarity: Array
    projection: Array | None
    axes: Array
    profile: Profile
    table_axis: Array
    unit_from_enu: Array
    frame_signs: Array
    white_noise: Array | None
    bias_instability: Array | None
    rate_random_walk: Array | None

    @classmethod
    def of_models(cls, run: Run, record: CalibrationRecord) -> RunFacts:
        """From run and calibration record as models."""
        return cls.of(run.model_dump(mode="json"), record.model_dump(mode="json"))

    @classmethod
    def of(cls, run: Mapping[str, Any], calibration: Mapping[str, Any]) -> RunFacts:
        """From run.yaml and calibration record as plain, validated data (``model_dump(mode="json")``)."""
        capture, table = run["capture"], run["table"]
        raw_unit = unit_of_capture(capture)
        projection = np.array(calibration["H"], float) if calibration.get("H") is not None else None
        axes = gyro_axes(projection) if projection is not None else np.array(calibration["axes"], float)
        steps = table["profile"]
        noise = calibration.get("noise") or {}

        def stated(key: str) -> Array | None:
            return None if noise.get(key) is None else np.array(noise[key], float)

        return cls(
            run_id=run["run_id"],
            unit=run["unit"],
            start_us=microseconds_since_1970(datetime.fromisoformat(run["started_at"])),
            sample_rate_hz=float(capture["sample_rate_hz"]),
            raw_unit=raw_unit,
            captured_in=capture.get("raw_unit", "V"),
            capture_least_count=float(capture.get("volts_per_count") or capture.get("least_count") or 1.0),
            latitude_deg=float(run["site"]["latitude_deg"]),
            scale_factor=np.array(calibration[raw_unit.scale_factor_key], float),
            bias=np.array(calibration[raw_unit.bias_key], float),
            polarity=np.array(capture["polarity"], float),
            projection=projection,
            axes=axes,
            profile=Profile(
                np.array([float(step["rate_deg_s"]) for step in steps]),
                np.array([float(step["duration_s"]) for step in steps]),
            ),
            table_axis=_unit_vector(table["axis"]),
            unit_from_enu=unit_from_enu(run["orientation"], float(run.get("azimuth_deg") or 0.0)),
            frame_signs=np.array(run.get("frame_signs") or [1, 1, 1], float),
            white_noise=stated("angle_random_walk_deg_sqrt_h"),
            bias_instability=stated("bias_instability_deg_h"),
            rate_random_walk=stated("rate_random_walk_deg_h_sqrt_h"),
        )

    @property
    def n_gyros(self) -> int:
        """Number of gyros, n."""
        return len(self.scale_factor)

    @property
    def is_increment(self) -> bool:
        """Whether captured readings are angle increments over a sample, to be divided by its interval."""
        return self.captured_in in INCREMENTS

    @property
    def least_count(self) -> float:
        """What one count stands for, or the least step of a reading [raw unit]."""
        return self.capture_least_count * (self.sample_rate_hz if self.is_increment else 1.0)

    @property
    def n_expected(self) -> int:
        """Records that a whole capture holds: ``round(duration x rate)``."""
        return round(math.fsum(self.profile.duration_s) * self.sample_rate_hz)

    @cached_property
    def earth(self) -> EarthPart:
        """What the projected axes read of Earth's rate."""
        return EarthPart.of(self.table_axis, self.unit_from_enu, self.latitude_deg, self.frame_signs)

    @property
    def commanded_signs(self) -> Array:
        """(3,): what each projected axis reads of one deg/s of commanded rate."""
        return self.frame_signs * self.table_axis


def _unit_vector(axis: str | list[float]) -> Array:
    """A table axis, by name or as a vector, as a unit vector."""
    vector = np.eye(3)[AXES.index(axis)] if isinstance(axis, str) else np.array(axis, float)
    return vector / np.linalg.norm(vector)

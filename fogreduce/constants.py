"""Physical and format constants, each in one place only."""

from __future__ import annotations

import math

#: Earth's rotation rate in inertial space [rad/s] (the value of the capture contract and of WGS 84).
EARTH_RATE_RAD_S = 7.2921151467e-5

#: The same in [deg/s]; 15.041 deg/h.
EARTH_RATE_DEG_S = math.degrees(EARTH_RATE_RAD_S)

SECONDS_PER_HOUR = 3600.0
MICROSECONDS_PER_SECOND = 1_000_000

#: Format of a run's manifest.
MANIFEST_SCHEMA = "fogreduce/manifest/1"
OUTPUTS_SCHEMA = "fogreduce/outputs/1"

#: The count that stands for "this gyro did not answer this pulse" in ``fogcap-1``.
MISSING_COUNT = -(2**31)

#: Counts are kept to +- this value.
LARGEST_COUNT = 2**31 - 1

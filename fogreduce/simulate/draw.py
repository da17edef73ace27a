"""The stated uncertainties, drawn: what a campaign may really have been, when nothing is wrong.

What is drawn is written as effects of the catalogue, so that it can be read, compared and put in again.
A gyro's scale factor, bias and axis, the table's rate and the latitude are the same in all runs of a
campaign; turn-on bias and azimuth are new in each run (capture contract).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.effects_file import EffectEntry
from fogreduce.metadata.run import Run
from fogreduce.physics.frames import across
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]


def draw_uncertainties(
    runs: Sequence[Run], record: CalibrationRecord, axes: Array, seed: int
) -> list[EffectEntry]:
    """Entries that put one draw of every stated uncertainty into a campaign's runs.

    Parameters
    ----------
    runs : sequence of Run
        All runs that were calibrated by `record`.
    record : CalibrationRecord
        It states what a gyro's uncertainties are.
    axes : (n, 3) array
        G.
    seed : int
        Each number has a stream of its own.
    """
    stated = record.stated_uncertainty

    def normal(sigma: float, *words: str) -> float:
        return sigma * float(stream(seed, "uncertainty", *words).standard_normal())

    def entry(effect: str, channel: str, run_ids: Sequence[str], **parameters: object) -> EffectEntry:
        return EffectEntry.model_validate(
            {"effect": effect, "channels": (channel,), "runs": tuple(run_ids), "parameters": parameters}
        )

    ids = [run.run_id for run in runs]
    entries = []
    # The table and the latitude are common to a campaign; where runs state different uncertainties, each
    # has its own multiple of the one draw.
    for run in runs:
        ppm = normal(run.table.rate_uncertainty_ppm, "table rate")
        latitude = normal(run.site.latitude_uncertainty_deg, "latitude")
        azimuth = normal(run.azimuth_uncertainty_deg, run.run_id, "azimuth")
        entries.append(entry("table_rate_error", "table", [run.run_id], ppm=ppm))
        entries.append(entry("latitude_error", "table", [run.run_id], deg=latitude))
        entries.append(entry("heading_error", "table", [run.run_id], deg=azimuth))
    for i in range(record.n):
        gyro, scale = f"gyro{i + 1}", record.scale_factor[i]
        relative = normal(stated.scale_factor_rel[i], record.unit, gyro, "scale factor")
        shift = normal(stated.bias[i], record.unit, gyro, "bias")
        first, second = across(axes[i])
        tilt = normal(stated.axis_rad[i], record.unit, gyro, "axis, first") * first
        tilt = tilt + normal(stated.axis_rad[i], record.unit, gyro, "axis, second") * second
        # M -> v = C (1 + e) (M + bias): a shift of the raw reading is one of the rate, through the true C.
        bias = shift / (scale * (1.0 + relative)) * SECONDS_PER_HOUR
        entries.append(entry("scale_factor_error", gyro, ids, ppm=relative * 1e6))
        entries.append(entry("bias_offset", gyro, ids, deg_h=bias))
        entries.append(entry("axis_misalignment", gyro, ids, mrad=tuple((tilt * 1e3).tolist())))
        for run_id in ids:
            turn_on = normal(stated.turn_on_bias_deg_h[i], run_id, gyro, "turn-on bias")
            entries.append(entry("turn_on_bias", gyro, [run_id], deg_h=turn_on))
    return entries

"""What the stated uncertainties turned out to be in one campaign."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Campaign
from withheld.streams import stream


@dataclass(frozen=True)
class Truth:
    """Departures of the world from what the metadata state, all within the stated uncertainties.

    Parameters
    ----------
    scale_factor_rel, bias_V : (n,)
    axis_tilt_rad : (n, 2), along the two directions of `across`
    turn_on_deg_h : run id -> (n,)
    azimuth_deg : run id -> float
    table_ppm, latitude_deg : float
    noise_level : (n,), factor on the record's white noise, which is not stated to the last per cent
    """

    scale_factor_rel: Array
    bias_V: Array
    axis_tilt_rad: Array
    noise_level: Array
    turn_on_deg_h: Mapping[str, Array] = field(default_factory=dict)
    azimuth_deg: Mapping[str, float] = field(default_factory=dict)
    table_ppm: float = 0.0
    latitude_deg: float = 0.0


def nominal(campaign: Campaign) -> Truth:
    """A world that is exactly as stated."""
    n = campaign.unit.n
    zero = np.zeros(n)
    return Truth(
        zero, zero, np.zeros((n, 2)), np.ones(n),
        {run.run_id: zero for run in campaign.runs}, {run.run_id: 0.0 for run in campaign.runs},
    )  # fmt: skip


def draw(campaign: Campaign, seed: int, noise_level_rel: float) -> Truth:
    """Draw every stated uncertainty, each from its own stream.

    `noise_level_rel` [1 sigma, relative] is how well a record's white noise is known; the contract states no
    number for it, so the study's protocol does.
    """
    unit = campaign.unit
    common = stream(seed, campaign.name, "uncertainty", "common")
    level = stream(seed, campaign.name, "uncertainty", "noise level").standard_normal(unit.n)
    turn_on, azimuth = {}, {}
    for run in campaign.runs:
        own = stream(seed, campaign.name, "uncertainty", run.run_id)
        turn_on[run.run_id] = own.standard_normal(unit.n) * np.array(unit.turn_on_deg_h)
        azimuth[run.run_id] = float(own.standard_normal() * run.azimuth_uncertainty_deg)
    first = campaign.runs[0]
    return Truth(
        scale_factor_rel=common.standard_normal(unit.n) * np.array(unit.scale_factor_rel),
        bias_V=common.standard_normal(unit.n) * np.array(unit.bias_sd),
        axis_tilt_rad=common.standard_normal((unit.n, 2)) * np.array(unit.axis_rad)[:, None],
        noise_level=np.exp(noise_level_rel * np.clip(level, -2.0, 2.0)),
        turn_on_deg_h=turn_on,
        azimuth_deg=azimuth,
        table_ppm=float(common.standard_normal() * first.rate_uncertainty_ppm),
        latitude_deg=float(common.standard_normal() * first.latitude_uncertainty_deg),
    )


def across(axes: Array) -> Array:
    """For each gyro two directions at right angles to its axis and to each other, (n, 2, 3)."""
    pairs = []
    for axis in axes / np.linalg.norm(axes, axis=1, keepdims=True):
        helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
        first = np.cross(axis, helper)
        first /= np.linalg.norm(first)
        pairs.append([first, np.cross(axis, first)])
    return np.array(pairs)

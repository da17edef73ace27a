"""What a lab might run: sets of runs from one standstill to eight turns, and how often each is drawn."""

from dataclasses import replace

import numpy as np

from withheld.chain.campaign import Campaign, Run
from withheld.study.units import draw_unit

AXIS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
UPRIGHT = {
    "x": (("x", "up"), ("z", "north")),
    "y": (("y", "up"), ("x", "north")),
    "z": (("z", "up"), ("y", "north")),
}
LATITUDES_DEG = (-23.21132308, 52.3, 37.4, -33.9, 64.1, 1.3)
# name: weight in a study, and whether the table turns at all
DESIGNS = {
    "eight": 0.52,
    "eight_slow": 0.06,
    "eight_static": 0.06,
    "three": 0.12,
    "two": 0.10,
    "one_constant": 0.07,
    "one_many_rate": 0.05,
    "one_static": 0.02,
}
# Short and long ones that the first studies had not: two standstills of 120 s, a run of 100 minutes.
SHORT_AND_LONG = {"two_static": 0.1, "one_long": 0.05}
Profile = tuple[tuple[float, float], ...]


def _turns(design: str, rng: np.random.Generator) -> list[tuple[str, Profile]]:
    """Axis and profile of each run."""
    rate, slow = round(float(rng.uniform(6.0, 18.0)), 2), round(float(rng.uniform(0.1, 1.0)), 3)
    length = 300.0
    axis = "xyz"[rng.integers(3)]
    still: Profile = ((0.0, length),)
    fast, back, crawl = ((rate, length),), ((-rate, length),), ((slow, length),)
    if design == "eight":
        return [(a, p) for a in "xyz" for p in (fast, back)] + [(axis, crawl), (axis, still)]
    if design == "eight_slow":
        crawls = [(a, ((s * slow, length),)) for a in "xyz" for s in (1.0, -1.0)]
        return [*crawls, (axis, ((2 * slow, length),)), (axis, still)]
    if design == "eight_static":
        return [("xyz"[k % 3], still) for k in range(8)]
    if design == "three":
        return [(axis, fast), (axis, back), (axis, still)]
    if design == "two":
        other = "xyz"[("xyz".index(axis) + 1) % 3]
        return [(axis, fast), (axis, back) if rng.random() < 0.5 else (other, fast)]
    if design == "one_constant":
        return [(axis, ((rate if rng.random() < 0.5 else slow, 600.0),))]
    if design == "one_many_rate":
        steps = (0.0, 2.0, -2.0, 5.0, -5.0, 12.0, -12.0, 0.0)
        return [(axis, tuple((step, 60.0) for step in steps))]
    if design == "two_static":
        return [(axis, ((0.0, 120.0),))] * 2
    if design == "one_long":
        return [(axis, ((0.06, 6000.0),))]
    if design == "one_static":
        return [(axis, ((0.0, 600.0),))]
    raise ValueError(f"no design {design}; expected one of {', '.join({**DESIGNS, **SHORT_AND_LONG})}")


def _tumbled(design: str, number: int, axis: str) -> tuple[tuple[str, str], tuple[str, str]]:
    """The table's axis stands upright; a tumble test turns it downward every other time."""
    (up, _), second = UPRIGHT[axis]
    down = design == "eight_static" and number >= 3 and number % 2 == 1
    return (up, "down" if down else "up"), second


def draw_campaign(
    name: str, design: str, gyros: int, rng: np.random.Generator, temperature: bool
) -> Campaign:
    """A unit and its runs, without anything wrong."""
    unit = draw_unit(gyros, f"UNIT-{gyros}{chr(65 + rng.integers(26))}", rng)
    polarity = tuple(int(v) for v in rng.choice([1, -1], gyros, p=[0.75, 0.25]))
    latitude = LATITUDES_DEG[rng.integers(len(LATITUDES_DEG))]
    sample_rate = float(rng.choice([128.0, 100.0, 64.0], p=[0.84, 0.08, 0.08]))
    signs = [1, 1, 1]
    if rng.random() < 0.15:
        signs[rng.integers(3)] = -1
    rate_ppm, azimuth_sd = float(rng.choice([5.0, 15.0])), float(rng.choice([0.05, 0.02, 0.1]))
    table_log, azimuth = bool(rng.random() < 0.4), round(float(rng.uniform(0.0, 360.0)), 3)
    runs = []
    for number, (axis, profile) in enumerate(_turns(design, rng), start=1):
        runs.append(
            Run(
                run_id=f"run-{number}", started_at=f"2026-03-0{1 + rng.integers(9)}T{6 + number:02d}:00:00Z",
                latitude_deg=latitude, axis=AXIS[axis], profile=profile,
                orientation=_tumbled(design, number, axis), azimuth_deg=azimuth, polarity=polarity,
                frame_signs=(signs[0], signs[1], signs[2]), rate_uncertainty_ppm=rate_ppm,
                azimuth_uncertainty_deg=azimuth_sd, sample_rate_hz=sample_rate,
                temperature=temperature, table_log=table_log,
            )
        )  # fmt: skip
    return Campaign(name, replace(unit, name=f"{unit.name}-{name}"), tuple(runs))


def any_campaign(
    name: str, rng: np.random.Generator, temperature_share: float, designs: dict[str, float] = DESIGNS
) -> tuple[str, Campaign]:
    """A design drawn by weight, and a campaign of it: four gyros mostly, else three or six."""
    design = str(rng.choice(list(designs), p=np.array(list(designs.values()))))
    gyros = int(rng.choice([4, 3, 6], p=[0.7, 0.15, 0.15]))
    return design, draw_campaign(name, design, gyros, rng, bool(rng.random() < temperature_share))

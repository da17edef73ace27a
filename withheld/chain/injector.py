"""A campaign on disk: every run's capture, logs and metadata, with the given effects in it."""

import shutil
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from withheld import yaml12
from withheld.arrays import Counts, Stamps
from withheld.atomic import write_text
from withheld.chain.campaign import Campaign, Run, run_document, unit_document
from withheld.chain.capture_file import encode, write_capture
from withheld.chain.electronics import converted, counts, filtered, interference, noise_volts, volts
from withheld.chain.link import link, stamps_us
from withheld.chain.motion import motion
from withheld.chain.noise import noise
from withheld.chain.readings import readings
from withheld.chain.temperature import Temperature, realistic, straight
from withheld.chain.truth import Truth, draw, nominal
from withheld.effects.entry import Entry
from withheld.streams import stream


@dataclass(frozen=True)
class World:
    """A campaign as it really was: what was drawn, what is wrong, and its temperatures by run id."""

    campaign: Campaign
    truth: Truth
    entries: tuple[Entry, ...] = ()
    heat: dict[str, Temperature] = field(default_factory=dict)
    seed: int = 0
    noisy: bool = True


def exact_world(campaign: Campaign, entries: tuple[Entry, ...] = ()) -> World:
    """The catalogue's shapes to the letter: nothing drawn, no noise, a straight temperature ramp."""
    heat = {run.run_id: straight(run.duration_s) for run in campaign.runs}
    return World(campaign, nominal(campaign), entries, heat, noisy=False)


def realistic_world(
    campaign: Campaign, entries: tuple[Entry, ...], seed: int, noise_level_rel: float = 0.02
) -> World:
    """Everything drawn: uncertainties, noise levels, temperatures that the coil follows late."""
    start = stream(seed, campaign.name, "temperature").uniform(20.0, 27.0)
    heat = {
        run.run_id: realistic(run.duration_s, stream(seed, campaign.name, "temperature", run.run_id), start)
        for run in campaign.runs
    }
    return World(campaign, draw(campaign, seed, noise_level_rel), entries, heat, seed)


def run_counts(world: World, run: Run) -> tuple[Stamps, Counts]:
    """Stamps [us] (k,) and counts (k, n) of one run: the whole chain, in the contract's order."""
    unit, entries = world.campaign.unit, world.entries
    t = np.arange(run.samples) / run.sample_rate_hz
    v = volts(run, unit, world.truth, readings(run, unit, world.truth, entries, world.heat[run.run_id], t))
    added = interference(run, unit, entries, t)
    if world.noisy:
        added += noise(run, unit, world.truth, entries, world.seed, world.campaign.name)
    v += noise_volts(run, unit, added)
    v = converted(run, entries, filtered(run, entries, v, 1.0 / run.sample_rate_hz))
    whole = counts(run, entries, v)
    return stamps_us(run, entries), link(run, entries, whole, world.seed, world.campaign.name)


def run_bytes(world: World, run: Run) -> bytes:
    """One run's capture file."""
    return encode(run, world.campaign.unit, *run_counts(world, run))


def _temperature_csv(heat: Temperature) -> str:
    rows = zip(heat.time_s.tolist(), heat.electronics_degC.tolist(), heat.sensor_degC.tolist(), strict=True)
    return "time_s,electronics_degC,sensor_degC\n" + "".join(f"{t:.1f},{e:.3f},{s:.4f}\n" for t, e, s in rows)


def _table_csv(world: World, run: Run) -> str:
    """The encoder's log, once a second: the true angle, read with an error of 1e-4 deg."""
    t = np.arange(0.0, np.floor(run.duration_s) + 1.0)
    angle = np.rad2deg(motion(run, world.truth, world.entries, t).alpha_rad)
    error = 1e-4 * stream(world.seed, world.campaign.name, "encoder", run.run_id).standard_normal(t.size)
    rows = zip(t.tolist(), (angle + error * world.noisy).tolist(), strict=True)
    return "time_s,angle_deg\n" + "".join(f"{a:.1f},{b:.4f}\n" for a, b in rows)


def write_campaign(world: World, folder: Path, calibrations: Path) -> None:
    """The campaign folder and its unit's calibration record; a folder already there is replaced whole."""
    unit = world.campaign.unit
    record = calibrations / unit.name / f"{unit.version}.yaml"
    write_text(record, yaml12.dump(unit_document(unit)))
    partial = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(partial, ignore_errors=True)
    for run in world.campaign.runs:
        here = partial / "runs" / run.run_id
        here.mkdir(parents=True)
        stamps, whole = run_counts(world, run)
        write_capture(here / "capture.fogcap", run, unit, stamps, whole)
        if run.temperature:
            write_text(here / "temperature.csv", _temperature_csv(world.heat[run.run_id]))
        if run.table_log:
            write_text(here / "table.csv", _table_csv(world, run))
        write_text(here / "run.yaml", yaml12.dump(run_document(run, unit)))
    shutil.rmtree(folder, ignore_errors=True)
    partial.rename(folder)

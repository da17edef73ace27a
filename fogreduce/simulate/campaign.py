"""A campaign, simulated: a folder that the reduction takes as it is, and beside it what was put in.

Everything is made in a temporary folder and takes its place, whole, at the end.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.logs import read_temperature
from fogreduce.effects.selection import Action, read_actions, select
from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.curves import Curves
from fogreduce.metadata.effects_file import EffectEntry, EffectsFile
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import cross_check, list_runs, load_calibration, load_campaign, load_run
from fogreduce.metadata.run import Run
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.simulate.capture import write_capture
from fogreduce.simulate.draw import axes_of, draw_uncertainties
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.from_curves import blocks_from_curves
from fogreduce.simulate.nominal_noise import NoiseCoefficients
from fogreduce.simulate.publish import published


@dataclass(frozen=True)
class Options:
    """What `simulate_campaign` is asked for.

    Attributes
    ----------
    effects_file : Path or None
    seed : int or None
        None: the one that campaign.yaml states, else 0.
    noise : bool
        False leaves only rounding (and effects).
    draw_uncertainties : bool
    only_runs : tuple of str
        Empty: all.
    """

    effects_file: Path | None = None
    seed: int | None = None
    noise: bool = True
    draw_uncertainties: bool = False
    only_runs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Loaded:
    """A campaign's metadata, checked."""

    folder: Path
    campaign: Campaign
    runs: dict[str, Run]
    records: dict[str, CalibrationRecord] = field(default_factory=dict)

    def record_of(self, run: Run) -> CalibrationRecord:
        """The calibration record of a run."""
        return self.records[run.calibration]

    def facts_of(self, run: Run) -> RunFacts:
        """A run's numbers."""
        return RunFacts.of(run.model_dump(mode="json"), self.record_of(run).model_dump(mode="json"))


def load(campaign_dir: Path, calibrations_dir: Path) -> Loaded:
    """Read a campaign's metadata and calibration records; BadInput with every fault."""
    faults: list[Fault] = []
    runs: dict[str, Run] = {}
    records: dict[str, CalibrationRecord] = {}
    campaign = load_campaign(campaign_dir)
    for folder in list_runs(campaign_dir):
        try:
            run = load_run(folder, need_capture=False)
            if run.calibration not in records:
                records[run.calibration], _ = load_calibration(calibrations_dir, run.calibration)
            cross_check(run, records[run.calibration], folder / "run.yaml")
            runs[run.run_id] = run
        except BadInput as error:
            faults += error.faults
    if faults:
        raise BadInput(*dict.fromkeys(faults))
    return Loaded(campaign_dir, campaign, runs, records)


def simulate_campaign(campaign_dir: Path, calibrations_dir: Path, out: Path, options: Options) -> list[str]:
    """Simulate every run of a campaign into the campaign folder `out`; the ids of the runs made.

    Beside it, ``<out>.injected.yaml`` says what was put in: seed, effects, and what was drawn.
    """
    loaded = load(campaign_dir, calibrations_dir)
    chosen = _chosen(loaded, options.only_runs)
    _refuse_out(campaign_dir, out, loaded)
    seed = _seed(loaded.campaign, options)
    actions, drawn = _actions(loaded, options, seed)
    from_curves = _curves(loaded, options)
    with published(out) as folder:
        _write_campaign_yaml(loaded, folder)
        for run_id in _progress(chosen):
            run = loaded.runs[run_id]
            facts, here = loaded.facts_of(run), folder / "runs" / run_id
            _copy_metadata(loaded, run, here)
            if from_curves is not None:
                blocks = blocks_from_curves(from_curves, facts, noise=options.noise)
            else:
                blocks = _forward(loaded, run, facts, actions, seed, noise=options.noise).blocks()
            write_capture(here / run.capture.file, run.capture.format, facts, blocks)
    write_text(injected_path(out), _injected(options, seed, drawn, from_curves))
    return chosen


def injected_path(out: Path) -> Path:
    """Where it is written what was put in: beside the campaign folder, never inside it."""
    whole = out.absolute()
    return whole.with_name(whole.name + ".injected.yaml")


def _forward(
    loaded: Loaded, run: Run, facts: RunFacts, actions: Sequence[Action], seed: int, *, noise: bool
) -> ForwardRun:
    stated = loaded.record_of(run).stated_noise.model_dump()
    temperature = None
    if run.temperature is not None and any(a.effect.needs_temperature for a in actions):
        temperature = read_temperature(loaded.folder / "runs" / run.run_id / run.temperature)
    return ForwardRun(facts, NoiseCoefficients.of(stated) if noise else None, actions, temperature, seed)


def _chosen(loaded: Loaded, only_runs: Sequence[str]) -> list[str]:
    known = ", ".join(loaded.runs)
    wrong = [
        Fault("--only-runs", "", name, f"one of {known}") for name in only_runs if name not in loaded.runs
    ]
    if wrong:
        raise BadInput(*wrong)
    return [run_id for run_id in loaded.runs if not only_runs or run_id in only_runs]


def _seed(campaign: Campaign, options: Options) -> int:
    if options.seed is not None:
        return options.seed
    made = campaign.captures_from
    return made.simulate.seed if made and made.simulate else 0


def _curves(loaded: Loaded, options: Options) -> Curves | None:
    """The curves from which the captures are to be made, where campaign.yaml says so."""
    made = loaded.campaign.captures_from
    if made is None or made.curves is None:
        return None
    file = loaded.folder / made.curves
    if options.effects_file or options.draw_uncertainties or options.seed is not None:
        raise BadInput.at(
            loaded.folder / "campaign.yaml",
            "captures_from.curves",
            found="captures made from curves",
            expected="captures made by the forward physics, for effects, draws and seeds",
        )
    curves = Curves.from_yaml(file)
    wrong = [
        Fault(
            str(file),
            "a_V",
            f"curves of {curves.n} gyros",
            f"{len(run.capture.polarity)}, as run {run.run_id} has",
        )
        for run in loaded.runs.values()
        if len(run.capture.polarity) != curves.n
    ]
    if wrong:
        raise BadInput(*wrong)
    return curves


def _actions(loaded: Loaded, options: Options, seed: int) -> tuple[list[Action], list[EffectEntry]]:
    """What acts: the file's effects, then what was drawn; and the entries that were drawn."""
    run_ids = list(loaded.runs)
    n_gyros = min(record.n for record in loaded.records.values())
    actions: list[Action] = []
    if options.effects_file is not None:
        actions = read_actions(options.effects_file, run_ids, n_gyros)
        _need_temperature(loaded, actions, options.effects_file)
    drawn: list[EffectEntry] = []
    if options.draw_uncertainties:
        for record_id, record in loaded.records.items():
            runs = [run for run in loaded.runs.values() if run.calibration == record_id]
            drawn += draw_uncertainties(runs, record, axes_of(runs[0], record), seed)
    return actions + select(drawn, run_ids, max(r.n for r in loaded.records.values()), "drawn"), drawn


def _need_temperature(loaded: Loaded, actions: Sequence[Action], file: Path) -> None:
    """Every fault of an effect of temperature in a run without a log."""
    wrong = [
        Fault(str(file), action.effect.name, f"run {run_id} without a temperature log", "runs with one")
        for action in actions
        for run_id in sorted(action.runs)
        if action.effect.needs_temperature and loaded.runs[run_id].temperature is None
    ]
    if wrong:
        raise BadInput(*wrong)


def _refuse_out(campaign_dir: Path, out: Path, loaded: Loaded) -> None:
    """An output folder that is the campaign itself, or holds other things."""
    if out.exists() and not out.is_dir():
        raise BadInput.at(out, "", found="a file", expected="a folder, or nothing yet")
    if out.resolve() == campaign_dir.resolve():
        raise BadInput.at(
            out, "", found="the campaign itself", expected="another folder, so that no capture is lost"
        )
    runs = out / "runs"
    if runs.is_dir():
        others = [
            path.name for path in sorted(runs.iterdir()) if path.is_dir() and path.name not in loaded.runs
        ]
        others = [name for name in others if not name.startswith(".")]
        if others:
            raise BadInput.at(
                out, "runs", found=f"other runs ({', '.join(others)})", expected="an empty folder"
            )


def _write_campaign_yaml(loaded: Loaded, folder: Path) -> None:
    """campaign.yaml, less what says how captures are made: they are there now."""
    kept = loaded.campaign.model_copy(update={"captures_from": None})
    if (loaded.folder / "campaign.yaml").exists():
        write_text(folder / "campaign.yaml", dump_yaml(kept.model_dump(mode="json", exclude_none=True)))


def _copy_metadata(loaded: Loaded, run: Run, here: Path) -> None:
    """run.yaml and logs, as they stand."""
    here.mkdir(parents=True)
    source = loaded.folder / "runs" / run.run_id
    for name in ("run.yaml", run.temperature, run.table_log):
        if name is not None:
            shutil.copyfile(source / name, here / name)


def _injected(options: Options, seed: int, drawn: Sequence[EffectEntry], curves: Curves | None) -> str:
    """What was put in, as YAML; its effects and draws are entries of an effects file."""
    injected: tuple[EffectEntry, ...] = ()
    if options.effects_file is not None:
        injected = EffectsFile.from_yaml(options.effects_file).effects
    return dump_yaml(
        {
            "schema": "fogreduce/injected/1",
            "seed": seed if curves is None else curves.seed,
            "noise": options.noise,
            "effects": [entry.model_dump(mode="json") for entry in injected],
            "drawn": [entry.model_dump(mode="json") for entry in drawn],
        }
    )


def _progress(run_ids: Sequence[str]) -> Iterator[str]:
    """The run ids, with a bar on a terminal when it takes longer than two seconds."""
    import sys

    if len(run_ids) < 2 or not sys.stderr.isatty():
        yield from run_ids
        return
    from tqdm import tqdm

    yield from tqdm(run_ids, desc="simulate", unit="run", delay=2.0, leave=False)

"""What is to be simulated: a campaign's metadata, calibration records and effects, read and checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fogreduce.datasets.run_logs import temperatures_of
from fogreduce.effects.selection import Action, select
from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.curves import Curves
from fogreduce.metadata.effects_file import EffectEntry, EffectsFile
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import cross_check, list_runs, load_calibration, load_campaign, load_run
from fogreduce.metadata.part import Part
from fogreduce.metadata.run import Run
from fogreduce.simulate.draw import draw_uncertainties
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients


@dataclass(frozen=True)
class Options:
    """What a simulation is asked for.

    Attributes
    ----------
    effects_file : Path or None
        Effects to put in.
    seed : int or None
        None: the one that campaign.yaml states, else 0.
    noise : bool
        False leaves only rounding (and effects).
    draw_uncertainties : bool
        Whether the stated uncertainties are drawn.
    only_runs : tuple of str
        Empty: all.
    """

    effects_file: Path | None = None
    seed: int | None = None
    noise: bool = True
    draw_uncertainties: bool = False
    only_runs: tuple[str, ...] = ()
    part: Part | None = None


@dataclass(frozen=True)
class Plan:
    """A campaign ready to be simulated.

    Attributes
    ----------
    folder : Path
        The campaign's.
    campaign : Campaign
    runs : dict
        Runs by id: all, or those to make where they depend on no other.
    records : dict
        Calibration records by id (``<unit>@<version>``).
    chosen : list of str
        Ids of the runs to make.
    some : bool
        Whether the campaign may have more runs than are to be made.
    effects, drawn : tuples of EffectEntry
        What the effects file holds; what was drawn of the stated uncertainties.
    actions : list of Action
        Both, checked.
    curves : Curves or None
        Where captures are made from curves.
    seed : int
    noise : bool
    """

    folder: Path
    campaign: Campaign
    runs: dict[str, Run]
    records: dict[str, CalibrationRecord]
    chosen: list[str]
    some: bool
    effects: tuple[EffectEntry, ...]
    drawn: tuple[EffectEntry, ...]
    actions: list[Action]
    curves: Curves | None
    seed: int
    noise: bool

    @property
    def n_records(self) -> int:
        """Records of all the captures to make."""
        return sum(self.runs[run_id].n_expected for run_id in self.chosen)

    def facts(self, run_id: str) -> RunFacts:
        """A run's numbers."""
        run = self.runs[run_id]
        return RunFacts.of_models(run, self.records[run.calibration])

    def forward(self, run_id: str) -> ForwardRun:
        """A run, forward."""
        run, facts = self.runs[run_id], self.facts(run_id)
        noise = None
        if self.noise:
            noise = NoiseCoefficients.of(self.records[run.calibration].stated_noise.model_dump())
        temperature = None
        if any(a.effect.needs_temperature for a in self.actions):
            folder = self.folder / "runs" / run_id
            if run.temperature is not None or (folder / run.capture.file).is_file():
                temperature = temperatures_of(folder, run.model_dump(mode="json"), facts.start_us)
        return ForwardRun(facts, noise, self.actions, temperature, self.seed)


def prepare(campaign_dir: Path, calibrations_dir: Path, options: Options) -> Plan:
    """Read and check everything that a simulation needs; BadInput with every fault."""
    campaign = load_campaign(campaign_dir)
    # Effects and what is drawn may hold for several runs; without them a run needs no other.
    independent = options.effects_file is None and not options.draw_uncertainties
    needed = options.only_runs if independent else ()
    runs, records = _runs_and_records(campaign_dir, calibrations_dir, needed)
    if options.part is not None:
        records = {record_id: options.part.filled(record)[0] for record_id, record in records.items()}
    made = campaign.captures_from
    seed = options.seed
    if seed is None:
        seed = made.simulate.seed if made and made.simulate else 0
    curves = None
    if made is not None and made.curves is not None:
        curves = _curves(campaign_dir, made.curves, runs, options)
    effects: tuple[EffectEntry, ...] = ()
    if options.effects_file is not None:
        effects = EffectsFile.from_yaml(options.effects_file).effects
    actions = select(effects, list(runs), min(r.n for r in records.values()), options.effects_file)
    _need_temperature(actions, runs, options.effects_file)
    drawn: list[EffectEntry] = []
    if options.draw_uncertainties:
        for record_id, record in records.items():
            its = [run for run in runs.values() if run.calibration == record_id]
            drawn += draw_uncertainties(its, record, RunFacts.of_models(its[0], record).axes, seed)
    return Plan(
        folder=campaign_dir,
        campaign=campaign,
        runs=runs,
        records=records,
        chosen=_chosen(runs, options.only_runs),
        some=bool(options.only_runs),
        effects=effects,
        drawn=tuple(drawn),
        actions=actions + select(drawn, list(runs), max(r.n for r in records.values()), "drawn"),
        curves=curves,
        seed=seed,
        noise=options.noise,
    )


def _runs_and_records(
    campaign_dir: Path, calibrations_dir: Path, only: Sequence[str]
) -> tuple[dict[str, Run], dict[str, CalibrationRecord]]:
    folders = list_runs(campaign_dir)
    if set(only) <= {folder.name for folder in folders}:
        folders = [folder for folder in folders if not only or folder.name in only]
    faults: list[Fault] = []
    runs: dict[str, Run] = {}
    records: dict[str, CalibrationRecord] = {}
    for folder in folders:
        try:
            run = load_run(folder, need_capture=False)
            if run.calibration not in records:
                records[run.calibration], _ = load_calibration(calibrations_dir, run.calibration)
            cross_check(run, records[run.calibration], folder / "run.yaml")
            if run.n_expected == 0:
                faults.append(
                    Fault(
                        str(folder / "run.yaml"),
                        "table.profile",
                        f"{run.duration_s:g} s, no sample",
                        "a longer one",
                    )
                )
            runs[run.run_id] = run
        except BadInput as error:
            faults += error.faults
    if faults:
        raise BadInput(*dict.fromkeys(faults))
    return runs, records


def _chosen(runs: dict[str, Run], only_runs: Sequence[str]) -> list[str]:
    names = ", ".join(runs)
    wrong = [Fault("--only-runs", "", name, f"one of {names}") for name in only_runs if name not in runs]
    if wrong:
        raise BadInput(*wrong)
    return [run_id for run_id in runs if not only_runs or run_id in only_runs]


def _curves(campaign_dir: Path, name: str, runs: dict[str, Run], options: Options) -> Curves:
    """The curves from which captures are to be made; they have no seed or effects but their own."""
    for option, given in (
        ("--effects", options.effects_file is not None),
        ("--draw-uncertainties", options.draw_uncertainties),
        ("--seed", options.seed is not None),
    ):
        if given:
            raise BadInput.at(
                campaign_dir / "campaign.yaml",
                "captures_from.curves",
                found=f"captures made from curves, and {option}",
                expected="captures made by the forward physics (captures_from.simulate, or none)",
            )
    curves = Curves.from_yaml(campaign_dir / name)
    wrong = [
        Fault(
            str(campaign_dir / name),
            "a_V",
            f"curves of {curves.n} gyros",
            f"{len(run.capture.polarity)}, as run {run_id} has",
        )
        for run_id, run in runs.items()
        if len(run.capture.polarity) != curves.n
    ]
    wrong += [
        Fault(str(campaign_dir / "runs" / run_id / "run.yaml"), "capture.raw_unit", unit, f"V, as {name}")
        for run_id, unit in ((run_id, run.capture.raw_unit) for run_id, run in runs.items())
        if unit != "V"
    ]
    if wrong:
        raise BadInput(*wrong)
    return curves


def _need_temperature(actions: Sequence[Action], runs: dict[str, Run], file: object) -> None:
    """Every fault of an effect of temperature in a run without a log."""
    wrong = [
        Fault(str(file), action.effect.name, f"run {run_id} without a temperature log", "runs with one")
        for action in actions
        for run_id in sorted(action.runs)
        if action.effect.needs_temperature and runs[run_id].temperature is None
    ]
    if wrong:
        raise BadInput(*wrong)

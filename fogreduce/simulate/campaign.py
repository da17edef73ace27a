"""A campaign, simulated: a folder that the reduction takes as it is, and beside it what was put in."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.logs import write_log
from fogreduce.datasets.run_logs import table_log_of, temperatures_of
from fogreduce.errors import BadInput
from fogreduce.metadata.folder import load_campaign
from fogreduce.metadata.run import Run
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml
from fogreduce.progress import Progress, silent
from fogreduce.simulate.capture import (
    TABLE_FILE,
    TEMPERATURE_FILE,
    Blocks,
    simulated,
    write_capture,
)
from fogreduce.simulate.earlier_captures import (
    Marks,
    earlier_captures,
    listed_of_others,
    mark_of,
    sole_simulation_in,
)
from fogreduce.simulate.forward import SimulatedBlock
from fogreduce.simulate.from_curves import blocks_from_curves
from fogreduce.simulate.plan import Plan
from fogreduce.simulate.publish import published


def write_campaign(plan: Plan, out: Path, progress: Progress = silent, overwrite: bool = False) -> None:
    """Write the simulated campaign to the folder `out`.

    Beside it, ``<out>.injected.yaml`` says what was put in: seed, effects, what was drawn, and
    which captures are simulated.

    Parameters
    ----------
    plan : Plan
        From `prepare`.
    out : Path
        A folder, which need not exist; run.yaml and logs are copied, captures added.
    progress : callable
        Hears how many records are done.
    overwrite : bool
        Whether captures of an earlier simulation may be written over.

    Raises
    ------
    BadInput
        `out` lies in the campaign, holds other runs, a capture that no simulation wrote, or one of an earlier
        simulation that is not to be written over.
    """
    _refuse(plan, out)
    runs = {run_id: simulated(plan.runs[run_id]) for run_id in plan.chosen}
    places = {run_id: Path("runs", run_id, run.capture.file) for run_id, run in runs.items()}
    captures = {run_id: out / place for run_id, place in places.items()}
    marks = earlier_captures(captures, injected_path(out), overwrite)
    done = 0
    with published(out) as folder:
        write_campaign_yaml(plan.folder, folder)
        for run_id, run in runs.items():
            _copy_metadata(plan, run, folder / "runs" / run_id)
            facts = plan.facts(run_id)
            blocks = _counted(_blocks(plan, run_id), done, progress)
            write_capture(folder / places[run_id], run.capture.format, facts, blocks)
            done += facts.n_expected
        made = [mark_of(run_id, folder / place) for run_id, place in places.items()]
        marks += [mark for mark in made if mark not in marks]
        # Before the captures take their places, so that none stands there that is not listed; what another
        # process, which simulates other runs, has listed meanwhile stays.
        with sole_simulation_in(injected_path(out).parent):
            others = listed_of_others(places, injected_path(out))
            write_text(injected_path(out), _injected(plan, [*others, *marks]))


def injected_path(out: Path) -> Path:
    """Where it is written what was put in: beside the campaign folder, never inside it."""
    whole = out.absolute()
    return whole.with_name(whole.name + ".injected.yaml")


def _blocks(plan: Plan, run_id: str) -> Iterator[SimulatedBlock]:
    if plan.curves is not None:
        return blocks_from_curves(plan.curves, plan.facts(run_id), noise=plan.noise)
    return plan.forward(run_id).blocks()


def _counted(blocks: Blocks, done: int, progress: Progress) -> Iterator[SimulatedBlock]:
    for block in blocks:
        yield block
        done += len(block.pulse)
        progress(done)


def _refuse(plan: Plan, out: Path) -> None:
    """An output folder that is the campaign itself, lies in it, or holds runs of another campaign.

    (Where some runs are added to a folder, which others stand there is not asked.)
    """
    if out.exists() and not out.is_dir():
        raise BadInput.at(out, "", found="a file", expected="a folder, or nothing yet")
    if out.resolve().is_relative_to(plan.folder.resolve()):
        found = (
            "the campaign itself" if out.resolve() == plan.folder.resolve() else "a folder in the campaign"
        )
        raise BadInput.at(out, "", found=found, expected="another folder, so that no capture is lost")
    runs = out / "runs"
    present = {path.name for path in runs.iterdir()} if runs.is_dir() else set()
    others = sorted(name for name in present - set(plan.runs) if not name.startswith("."))
    if others and not plan.some:
        raise BadInput.at(
            runs, "", found=f"runs of another campaign ({', '.join(others)})", expected="an empty folder"
        )


def write_campaign_yaml(campaign: Path, folder: Path) -> None:
    """campaign.yaml, less what says how captures are made: they are there now."""
    if (campaign / "campaign.yaml").exists():
        kept = load_campaign(campaign).model_copy(update={"captures_from": None})
        write_text(folder / "campaign.yaml", dump_yaml(kept.model_dump(mode="json", exclude_none=True)))


def _copy_metadata(plan: Plan, run: Run, here: Path) -> None:
    """run.yaml and logs, as they stand; run.yaml anew where the capture is simulated in another format."""
    here.mkdir(parents=True)
    source = plan.folder / "runs" / run.run_id
    planned = plan.runs[run.run_id]
    for name in ("run.yaml", planned.temperature, planned.table_log):
        if name is not None:
            shutil.copyfile(source / name, here / name)
    if run == planned:
        return
    changed: dict[str, object] = {"capture": run.capture.model_dump(mode="json", exclude_none=True)}
    plain, start_us = planned.model_dump(mode="json"), planned.start_us
    if (source / planned.capture.file).is_file():
        temperatures, angles = (read(source, plain, start_us) for read in (temperatures_of, table_log_of))
        if planned.temperature is None and temperatures is not None:
            write_log(here / TEMPERATURE_FILE, temperatures)
            changed["temperature"] = TEMPERATURE_FILE
        if planned.table_log is None and angles is not None:
            write_log(here / TABLE_FILE, angles)
            changed["table_log"] = TABLE_FILE
    write_text(here / "run.yaml", dump_yaml({**load_yaml(source / "run.yaml"), **changed}))


def _injected(plan: Plan, captures: Marks) -> str:
    """What was put in, as YAML; its effects and draws are entries of an effects file."""
    return dump_yaml(
        {
            "schema": "fogreduce/injected/1",
            "seed": plan.seed if plan.curves is None else plan.curves.seed,
            "noise": plan.noise,
            "effects": [entry.model_dump(mode="json") for entry in plan.effects],
            "drawn": [entry.model_dump(mode="json") for entry in plan.drawn],
            "captures": captures,
        }
    )

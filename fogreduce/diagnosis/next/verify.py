"""The next run, tried before it is made: simulated with each rival in turn as the truth, diagnosed again.

Today's captures stay as they are. Beside them comes a capture of the proposed run in which one rival acts at
its fitted value, with noise, and with a turn-on bias and an azimuth drawn from what is stated.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fogreduce.datasets.atomic import write_text
from fogreduce.diagnosis.diagnose import Diagnosis, diagnose
from fogreduce.diagnosis.effects_file import effects_text, entry
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.next.design import NextRun
from fogreduce.diagnosis.next.runs import RUN_ID, run_document, temperature, temperature_text
from fogreduce.diagnosis.report.words import in_words, named
from fogreduce.errors import BadInput
from fogreduce.metadata.part import Part
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.simulate.campaign import write_campaign
from fogreduce.simulate.plan import Options, prepare
from fogreduce.simulate.streams import stream

_MOST_TRUTHS = 4


def verified(
    diagnosis: Diagnosis,
    campaign: Path,
    calibrations: Path,
    without: Sequence[str] = (),
    only: Sequence[str] = (),
    part: Part | None = None,
) -> dict[str, Any] | None:
    """What `next_run` gets as ``verified``; None where no run is proposed.

    Parameters
    ----------
    diagnosis : Diagnosis
        Of the campaign's captures.
    campaign, calibrations : Path
    without, only, part :
        As it was made.

    Returns
    -------
    mapping
        ``separated``: whether every rival that the run is to separate was found when it was the truth, and
        no other of them with it; ``truths``: for each, what the second diagnosis said.
    """
    best = diagnosis.next_run
    if best is None:
        return None
    if (campaign / "runs" / RUN_ID).exists():
        raise BadInput.at(
            campaign / "runs" / RUN_ID,
            "",
            found="a run of that name",
            expected="it renamed, for --verify-next",
        )
    to_separate = best.document["separates"] or best.document["leaves"]
    others = [c for k, c in enumerate(diagnosis.verdict.state.causes) if k != best.one.index]
    truths = []
    # what a temperature without a log does cannot be simulated
    for truth in [c for c in best.rivals if named(c) in to_separate and not c.unlogged][:_MOST_TRUTHS]:
        with tempfile.TemporaryDirectory() as scratch:
            whole = _campaign(
                diagnosis,
                best,
                [*others, _refitted(diagnosis, others, truth)],
                campaign,
                calibrations,
                Path(scratch),
            )
            found = diagnose(whole, calibrations, without, _with_next(only), part=part).document
        truths.append(_outcome(found, truth, to_separate))
    return {"separated": bool(truths) and all(t["separated"] for t in truths), "truths": truths}


def _refitted(diagnosis: Diagnosis, others: Sequence[Cause], truth: Cause) -> Cause:
    """A rival with the values that fit best beside the other causes."""
    if not truth.slow:
        return truth
    state = diagnosis.search.state([*others, truth], diagnosis.verdict.state.problem)
    return state.causes[-1]


def _with_next(only: Sequence[str]) -> tuple[str, ...]:
    return (*only, RUN_ID) if only else ()


def _campaign(
    diagnosis: Diagnosis,
    best: NextRun,
    causes: Sequence[Cause],
    campaign: Path,
    calibrations: Path,
    scratch: Path,
) -> Path:
    """A campaign folder with today's runs and the next one's capture, in which the causes act."""
    inputs = diagnosis.data.inputs
    log = temperature(inputs, best.proposal)
    plan_folder, made = scratch / "plan", scratch / campaign.resolve().name
    here = plan_folder / "runs" / RUN_ID
    write_text(here / "run.yaml", dump_yaml(run_document(inputs[0].run, best.proposal, log is not None)))
    if log is not None:
        write_text(here / "temperature.csv", temperature_text(log))
    entries = [entry(c, [RUN_ID]) for c in causes if c.runs == ("*",) and not c.unlogged]
    write_text(scratch / "effects.yaml", effects_text(entries + _new_in_the_run(diagnosis)))
    options = Options(effects_file=scratch / "effects.yaml", seed=0, part=inputs[0].part)
    write_campaign(prepare(plan_folder, calibrations, options), made)
    for one in inputs:
        target = made / "runs" / one.facts.run_id
        target.mkdir(parents=True)
        run = one.run
        for name in ("run.yaml", run.capture.file, run.temperature, run.table_log):
            if name is not None:
                shutil.copyfile(one.folder / name, target / name)
    if (campaign / "campaign.yaml").exists():
        shutil.copyfile(campaign / "campaign.yaml", made / "campaign.yaml")
    return made


def _new_in_the_run(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Entries for what is new in each run: turn-on biases and azimuth, one draw of what is stated."""
    first = diagnosis.data.inputs[0]
    stated = first.record.stated_uncertainty.turn_on_bias_deg_h
    draw = stream(0, "next run").standard_normal(len(stated) + 1)
    entries: list[dict[str, Any]] = [
        {
            "effect": "turn_on_bias",
            "channels": [f"gyro{i + 1}"],
            "runs": [RUN_ID],
            "parameters": {"deg_h": sigma * draw[i]},
        }
        for i, sigma in enumerate(stated)
    ]
    azimuth = first.run.azimuth_uncertainty_deg * draw[-1]
    entries.append(
        {"effect": "heading_error", "channels": ["table"], "runs": [RUN_ID], "parameters": {"deg": azimuth}}
    )
    return entries


def _outcome(found: dict[str, Any], truth: Cause, to_separate: Sequence[str]) -> dict[str, Any]:
    """What the second diagnosis says of a truth."""
    causes = found["causes"]
    names = [in_words(c) for c in causes]
    groups = ([in_words(m) for m in c["group"]] for c in causes)
    group = next((members for members in groups if named(truth) in members), [])
    members = [m for c in causes for m in c["group"] if in_words(m) == named(truth)]
    rivals = [name for name in to_separate if name != named(truth)]
    return {
        "truth": named(truth),
        "verdict": found["verdict"],
        "causes": names,
        "probability": max((m["probability"] for m in members), default=0.0),
        "group": group,
        "separated": named(truth) in names and not any(name in group or name in names for name in rivals),
    }

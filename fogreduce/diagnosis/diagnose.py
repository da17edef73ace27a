"""A campaign, diagnosed: from folders to the document that a diagnosis is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fogreduce.diagnosis.effects_file import entry, plain
from fogreduce.diagnosis.how_far.by_cause import Share, shares
from fogreduce.diagnosis.how_far.closure import Closure, Key, measured
from fogreduce.diagnosis.how_far.remainder import Remainder, borne_out, remaining
from fogreduce.diagnosis.how_far.shapes import without_imitations
from fogreduce.diagnosis.how_far.simulated import Source
from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.outcome import Named, Verdict
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.significance import significance
from fogreduce.diagnosis.inference.tension import tensions
from fogreduce.diagnosis.inference.verdict import verdict_of_sets
from fogreduce.diagnosis.next.design import NextRun, proposed
from fogreduce.diagnosis.next.runs import ANY_BENCH
from fogreduce.diagnosis.observe.assumptions import assumed
from fogreduce.diagnosis.observe.data import Data, read_data
from fogreduce.diagnosis.where import places as where
from fogreduce.diagnosis.where.mistakes import mistakes
from fogreduce.diagnosis.where.places import Place
from fogreduce.effects.table import EFFECTS, catalogue
from fogreduce.metadata.bench import Bench
from fogreduce.metadata.part import Part

SCHEMA = "fogreduce/diagnosis/1"
#: The steps of a diagnosis, in order.
STEPS = ("reading", "spectra", "search", "closure", "next run")
_UNKNOWN = ("partly_explained", "unexplained")  # verdicts with something unknown in them


@dataclass(frozen=True)
class Diagnosis:
    """A diagnosis with what it rests on.

    Attributes
    ----------
    document : mapping
        What diagnosis.json holds.
    effects : list of mappings
        Causes as entries of an effects file; what a temperature without a log does cannot be among them.
    data, search, verdict : what it rests on
    places : list of Place
    closure : Closure or None
    next_run : NextRun or None
        None where no cause has rivals.
    """

    document: dict[str, Any]
    effects: list[dict[str, Any]]
    data: Data
    search: Search
    verdict: Verdict
    places: list[Place]
    closure: Closure | None
    next_run: NextRun | None


def diagnose(
    campaign: Path,
    calibrations: Path,
    without: Sequence[str] = (),
    only: Sequence[str] = (),
    simulated: Path | None = None,
    progress: Callable[[str], None] = lambda step: None,
    bench: Bench = ANY_BENCH,
    part: Part | None = None,
) -> Diagnosis:
    """Diagnose a campaign folder.

    Parameters
    ----------
    campaign, calibrations : Path
    without : names of effects
        Taken out of the catalogue.
    only : run ids
        Empty: all.
    simulated : Path or None
        A campaign folder whose captures are the prediction, in place of our own simulator's.
    progress : callable
        Hears which of `STEPS` begins.
    bench : Bench
        What table and chamber can do: the next run stays within it.
    part : Part or None
        A data sheet: it fills in what the record does not state, and gives sizes their priors.
    """
    allowed = catalogue(without)
    progress("reading")
    data = read_data(campaign, calibrations, only, simulated, part)
    progress("spectra")
    search = Search(data, allowed)
    progress("search")
    # where it lies needs no cause, and comes before them
    found = _places(search)
    verdict = without_imitations(search, verdict_of_sets(search))
    if verdict.word != "no_gap" and not found:
        found = [_faint(verdict, data)]
    closure = None
    left = remaining(
        search, verdict.state, None if simulated else Source(campaign, calibrations, tuple(only), part)
    )
    if verdict.word != "no_gap":
        progress("closure")
        closure = measured(search, verdict.state.causes, found)
        verdict = borne_out(verdict, closure, left)
    parts, kinds = ({}, {}) if closure is None else shares(data.inputs, verdict.state.causes, closure)
    progress("next run")
    proposal = proposed(search, verdict, bench) if verdict.named else None
    document = {
        "schema": SCHEMA,
        "campaign": campaign.resolve().name,
        "runs": data.run_ids,
        "raw_unit": data.inputs[0].facts.raw_unit.name,
        "catalogue": [name for name in EFFECTS if name in allowed],
        "verdict": verdict.word,
        "gap_probability": round(verdict.gap_probability, 6),
        "where": where.document(found) if verdict.word != "no_gap" else [],
        "causes": [_cause(verdict, one, parts) for one in verdict.named],
        "unknown_probability": round(verdict.unknown_probability, 6),
        "resembles": [one.document() for one in left.kin] if verdict.word in _UNKNOWN else [],
        "closure": None if closure is None else _closure(closure, kinds),
        "remainder": _remainder(left),
        "constant_gyros": [one.document() for one in data.constant],
        "lost_records": {run.run_id: [run.lost, run.expected] for run in data.full if run.lost},
        "stamps_jump_s": {run.run_id: run.stamps.jump_s for run in data.full if run.stamps.jump_s},
        "assumed": assumed(data),
        "part": None if part is None else _part(part),
        "tension": [one.document() for one in tensions(data.inputs, verdict.state)],
        "mistakes": mistakes(data, verdict.word, verdict.state.causes),
        "next_run": None if proposal is None else proposal.document,
    }
    effects = [entry(c) for c in verdict.state.causes if not c.unlogged]
    return Diagnosis(document, effects, data, search, verdict, found, closure, proposal)


def _places(search: Search) -> list[Place]:
    """Where the gap lies, causes aside."""
    problem = search.problem
    residual = search.state([], problem).residual
    faults = [*where.gross(residual, problem.candidates), *where.joined(problem.families)]
    seats = Candidates([*problem.families, *faults]) if faults else problem.families
    return where.places(
        residual,
        seats,
        search.full_rate.findings([]),
        lambda here: problem.processes.findings(here, search.allowed),
        search.data.run_ids,
    )


def _faint(verdict: Verdict, data: Data) -> Place:
    """The best place of a gap that no place alone shows beyond doubt."""
    unknown = [o for o in verdict.left if not o.catalogued] or verdict.left
    best = max(unknown, key=lambda o: o.log_b)
    if verdict.named and verdict.named[0].group:
        best = verdict.named[0].group[0][0]
    source = best.source
    runs = tuple(data.run_ids) if source.runs == ("*",) else source.runs
    sigma = significance(max(best.q, 0.0), 1)
    return Place(source.stage, source.channels, runs, source.feature or "mean", sigma, max(best.q, 1e-6), 1)


def _part(part: Part) -> dict[str, Any]:
    """The data sheet that priors were taken from, and the sizes that it has units show, by effect."""
    sizes = part.realistic()
    shown = {name: list(sizes[e.sheet]) for name, e in EFFECTS.items() if e.sheet in sizes}
    return {"product": part.product, "source": part.source, "sizes": shown}


def _cause(verdict: Verdict, one: Named, parts: Mapping[Key, Share]) -> dict[str, Any]:
    cause = verdict.state.causes[one.index]
    part = parts.get(cause.key)
    group = [
        {
            "effect": o.key[0],
            "channels": list(o.key[1]),
            "runs": list(o.key[2]),
            **_other_gyro(o.key),
            "probability": round(min(p, 1.0), 6),
        }
        for o, p in one.group
    ]
    return {
        "effect": cause.effect,
        "channels": list(cause.channels),
        "runs": list(cause.runs),
        "probability": round(min(one.probability, 1.0), 6),
        "group_probability": round(min(one.group_probability, 1.0), 6),
        "group": group,
        "parameters": plain(cause.stated()),
        "closure": None if part is None else asdict(part),
    }


def _other_gyro(key: Key) -> dict[str, Any]:
    """The parameter of a rival that names another gyro."""
    name = EFFECTS[key[0]].other
    return {"parameters": {name: {"value": key[3], "std": None}}} if name and key[3] else {}


def _closure(closure: Closure, kinds: Mapping[str, Share]) -> dict[str, Any]:
    ranked = sorted(kinds.items(), key=lambda kind: kind[1].rank)
    fraction, std = closure.fraction, closure.std
    out = {
        "measure": closure.measure,
        "held_out": closure.held_out,
        "before": closure.before,
        "after": closure.after,
        "expected_if_closed": closure.expected,
        "fraction": fraction,
        "std": std,
        "interval_95": [fraction - 1.96 * std, fraction + 1.96 * std],
        "kinds": [{"effect": effect, **asdict(part)} for effect, part in ranked],
    }
    if closure.placebo is not None:
        out["placebo_fraction"] = closure.placebo
    return out


def _remainder(left: Remainder) -> dict[str, Any]:
    """What is left beside the causes."""
    return {
        "significant": left.significant,
        "p_value": left.p_value,
        "departure_of_shape": left.significant and not left.further,
        "where": where.document(left.shown) if left.shown else [],
    }

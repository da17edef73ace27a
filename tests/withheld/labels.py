"""Labels and diagnoses by hand, for tests of the scorer."""

from typing import Any

from withheld.effects.catalogue import block
from withheld.score.diagnosis_file import Cause, Diagnosis


def effect(
    name: str, *channels: str, runs=("*",), snr=20.0, best=10.0, rivals=(), **parameters
) -> dict[str, Any]:
    """An effect of a label; `rivals`: (effect, channel, separation)."""
    return {
        "effect": name,
        "channels": list(channels),
        "runs": list(runs),
        "parameters": parameters,
        "block": block(name),
        "snr": snr,
        "best_rival": best,
        "attainable_std": 1.0 / snr,
        "rivals": [{"effect": e, "channels": [c], "runs": ["*"], "separation": d} for e, c, d in rivals],
    }


def label(kind: str, *effects: dict[str, Any], case="case-0001", oracle=None, without=()) -> dict[str, Any]:
    """A label."""
    return {
        "case": case,
        "kind": kind,
        "design": "eight",
        "gyros": 4,
        "effects": list(effects),
        "without": list(without),
        "runs": ["a", "b"],
        "temperature": True,
        "slow_snr": 20.0,
        "oracle_closure": oracle,
    }


def cause(name: str, *channels: str, runs=("*",), probability=0.9, group=(), **parameters) -> Cause:
    """A cause; `group`: further (effect, channel) members; parameters: (value, std)."""
    key = (name, tuple(channels), tuple(runs))
    members = (key, *((e, (c,), ("*",)) for e, c in group))
    return Cause(key, probability, 0.95, members, parameters)


def diagnosis(verdict: str, *causes: Cause, where=(), gap=0.99, unknown=0.02, closure=None) -> Diagnosis:
    """A diagnosis; `where`: (stage, channels)."""
    places = tuple((stage, tuple(channels), ("*",)) for stage, channels in where)
    return Diagnosis(verdict, gap, unknown, places, causes, closure)

"""A diagnosis as the contract has it, read strictly: what does not conform is no diagnosis."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from withheld.atomic import read_json
from withheld.errors import BadInput

VERDICTS = ("no_gap", "explained", "partly_explained", "unexplained")
STAGES = ("table", "gyro", "noise", "electronics", "link")
Key = tuple[str, tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True)
class Cause:
    """One effect judged present, with its rivals.  `parameters`: name -> (value, std), numbers only;
    `closure`: its own, as far as it is stated, with its `rank`.
    """

    key: Key
    probability: float
    group_probability: float
    group: tuple[Key, ...]
    parameters: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    closure: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Diagnosis:
    """What is scored of a diagnosis.json; `where`, `remainder`: (stage, channels, runs) in the order stated;
    `closure`: (fraction, std), `closure_reaches`: the upper end of its 95 % interval; `resembles`: (effect,
    channels, runs) likewise.
    """

    verdict: str
    gap_probability: float
    unknown_probability: float
    where: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...]
    causes: tuple[Cause, ...]
    closure: tuple[float, float] | None
    closure_reaches: float | None = None
    remainder: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...] = ()
    resembles: tuple[Key, ...] = ()


def _probability(value: Any, name: str, path: Path) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= 1.0:
        raise BadInput(f"{path}: {name} is {value!r}; expected a number from 0 to 1")
    return float(value)


def key_of(item: Mapping[str, Any]) -> Key:
    """Effect, channels and runs; all runs where none are named.

    A swap's partner, a parameter in the contract, counts among its channels, so that the two sides of a
    swap have one key.
    """
    channels = set(item["channels"])
    if item["effect"] == "channel_swap" and "with" in item.get("parameters", {}):
        partner = item["parameters"]["with"]
        channels.add(partner["value"] if isinstance(partner, Mapping) else partner)
    return (str(item["effect"]), tuple(sorted(channels)), tuple(sorted(item.get("runs", ("*",)))))


def _number_pairs(parameters: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Parameters that are numbers; a vector's components get their index as a suffix."""
    pairs: dict[str, tuple[float, float]] = {}
    for name, entry in parameters.items():
        if not isinstance(entry, Mapping) or entry.get("std") is None:
            continue
        value, std = entry["value"], entry["std"]
        if isinstance(value, list):
            errors = std if isinstance(std, list) else [std] * len(value)
            pairs |= {
                f"{name}[{k}]": (float(v), float(s))
                for k, (v, s) in enumerate(zip(value, errors, strict=True))
            }
        elif isinstance(value, int | float):
            pairs[name] = (float(value), float(std))
    return pairs


def _own_closure(stated: Mapping[str, Any]) -> dict[str, float]:
    """A cause's own closures and its rank, those that are numbers."""
    names = ("alone", "removed", "cumulative", "rank")
    return {name: float(stated[name]) for name in names if isinstance(stated.get(name), int | float)}


def _places(items: list[Mapping[str, Any]]) -> tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...]:
    return tuple((p["stage"], tuple(p["channels"]), tuple(p.get("runs", ("*",)))) for p in items)


def _cause(item: Mapping[str, Any], path: Path) -> Cause:
    probability = _probability(item["probability"], "a cause's probability", path)
    group = tuple(key_of(member) for member in item.get("group", [])) or (key_of(item),)
    return Cause(
        key_of(item), probability,
        _probability(item.get("group_probability", probability), "group_probability", path),
        group, _number_pairs(item.get("parameters", {})), _own_closure(item.get("closure") or {}),
    )  # fmt: skip


def read_diagnosis(path: Path) -> Diagnosis:
    """The diagnosis in `path`; anything that is not of the contract's form is bad input."""
    document = read_json(path)
    try:
        if document["schema"] != "fogreduce/diagnosis/1":
            raise BadInput(f"{path}: schema is {document['schema']!r}; expected fogreduce/diagnosis/1")
        if document["verdict"] not in VERDICTS:
            raise BadInput(
                f"{path}: verdict is {document['verdict']!r}; expected one of {', '.join(VERDICTS)}"
            )
        for place in document["where"]:
            if place["stage"] not in STAGES:
                raise BadInput(f"{path}: stage is {place['stage']!r}; expected one of {', '.join(STAGES)}")
        closure = document.get("closure")
        return Diagnosis(
            document["verdict"],
            _probability(document["gap_probability"], "gap_probability", path),
            _probability(document["unknown_probability"], "unknown_probability", path),
            _places(document["where"]),
            tuple(_cause(item, path) for item in document["causes"]),
            None if closure is None else (float(closure["fraction"]), float(closure["std"])),
            None if closure is None else float(closure["interval_95"][1]),
            _places((document.get("remainder") or {}).get("where") or []),
            tuple(key_of(item) for item in document.get("resembles") or []),
        )
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise BadInput(f"{path}: not of the contract's form ({error!r})") from error

"""When a stated cause is the truth, how far it is from it, and how far its numbers are."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from withheld.effects.catalogue import IN_ONE_RUN
from withheld.score.diagnosis_file import Cause, Key, key_of


def same(stated: Key, truth: Key) -> bool:
    """Whether a stated cause is the truth: effect and channels, and the run where the effect sits in one.

    A swap may be named from either side, its partner left out, but not with another partner.
    """
    if stated[0] != truth[0]:
        return False
    if truth[0] in IN_ONE_RUN and stated[2] != truth[2]:
        return False
    if truth[0] == "channel_swap":
        return bool(stated[1]) and set(stated[1]) <= set(truth[1])
    return stated[1] == truth[1]


def matches(key: Key, effect: Mapping[str, Any]) -> bool:
    """Whether a stated key is a label's effect."""
    return same(key, key_of(effect))


def separation_of(member: Key, effect: Mapping[str, Any], kept_below: float) -> float:
    """What the clairvoyant says of a stated member: 0 for the truth itself; `kept_below`, the largest that a
    label keeps, for what it does not list.
    """
    if matches(member, effect):
        return 0.0
    for rival in effect["rivals"]:
        if same(member, key_of(rival)):
            return float(rival["separation"])
    return kept_below


def in_pure_group(cause: Cause, effect: Mapping[str, Any], never: float) -> bool:
    """The truth is in the cause's group, and nobody who is far from it."""
    far = [m for m in cause.group if separation_of(m, effect, never) >= never]
    return any(matches(m, effect) for m in cause.group) and not far


def parameter_errors(cause: Cause, effect: Mapping[str, Any]) -> Iterator[tuple[float, float]]:
    """Of every number of a cause that is right by name: its error over its standard deviation, and its error
    over the true size (a vector's for its components, a turn for a phase).
    """
    truth: dict[str, tuple[float, float]] = {}
    for name, value in effect["parameters"].items():
        if isinstance(value, list):
            size = float(np.linalg.norm(value))
            truth |= {f"{name}[{k}]": (float(v), size) for k, v in enumerate(value)}
        elif isinstance(value, int | float):
            truth[name] = (float(value), 2.0 * math.pi if name == "phase_rad" else abs(float(value)))
    for name, (value, std) in cause.parameters.items():
        if std > 0.0 and name in truth:
            known, size = truth[name]
            error = _difference(effect["effect"], name, value, known)
            yield error / std, abs(error) / size if size else math.inf


def _difference(effect: str, name: str, value: float, known: float) -> float:
    """Stated less true, where one thing has two names: an angle, a turn on; a magnetic bias, negated with the
    field's direction turned round.
    """
    if name == "phase_rad":
        return math.remainder(value - known, 2.0 * math.pi)
    if effect == "magnetic_bias" and name == "deg_h":
        return abs(value) - abs(known)
    return value - known

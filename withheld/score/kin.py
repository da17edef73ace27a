"""Whether a diagnosis says of an unknown effect what it resembles."""

from collections.abc import Mapping
from typing import Any

from withheld.effects.near import KIN
from withheld.score.diagnosis_file import Diagnosis


def kin_of(effect: Mapping[str, Any]) -> set[str]:
    """The effect's kin: what it is a departure from, and the catalogue's nearest by the clairvoyant."""
    return {KIN[effect["effect"]], *([effect["nearest"]["effect"]] if effect["nearest"] else [])}


def kin_named(effect: Mapping[str, Any], diagnosis: Diagnosis, in_place: bool) -> bool:
    """Named unknown in its place, with its kin the first that it resembles; or its kin named on its gyro, and
    the departure of shape shown there in the remainder.
    """
    kin, gyros = kin_of(effect), set(effect["channels"])
    first = diagnosis.resembles[0] if diagnosis.resembles else None
    unknown = diagnosis.verdict in ("unexplained", "partly_explained")
    if unknown and in_place and first is not None and first[0] in kin and set(first[1]) <= gyros:
        return True
    named = any(cause.key[0] in kin and set(cause.key[1]) == gyros for cause in diagnosis.causes)
    shown = any(gyros & set(channels) for _, channels, _ in diagnosis.remainder)
    return named and shown

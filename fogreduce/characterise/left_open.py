"""Whether a campaign leaves a parameter of a gyro open, as the derivation says in words."""

from __future__ import annotations

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.undetermined import BIAS, SCALE_FACTOR, axis_words
from fogreduce.physics.frames import across


def bias_is_open(found: Derivation, gyro: int) -> bool:
    """Whether the bias of a gyro is open."""
    return _is_open(found, BIAS.format(gyro + 1))


def scale_factor_is_open(found: Derivation, gyro: int) -> bool:
    """Whether the scale factor of a gyro is open."""
    return _is_open(found, SCALE_FACTOR.format(gyro + 1))


def axis_is_open(found: Derivation, gyro: int, direction: int) -> bool:
    """Whether a gyro's axis is open towards the first or second direction across it."""
    axis = found.readings[0].facts.axes[gyro]
    return _is_open(found, axis_words(gyro, across(axis)[direction]))


def _is_open(found: Derivation, words: str) -> bool:
    return any(words in one.words for one in found.undetermined)

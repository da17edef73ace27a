"""Gyros by name, as people count them: gyro1 is the first."""

from __future__ import annotations


def gyro_name(index: int) -> str:
    """``gyro1`` for 0."""
    return f"gyro{index + 1}"


def gyro_index(name: str) -> int:
    """0 for ``gyro1``; -1 for what is no gyro's name."""
    digits = name.removeprefix("gyro")
    return int(digits) - 1 if name.startswith("gyro") and digits.isascii() and digits.isdigit() else -1

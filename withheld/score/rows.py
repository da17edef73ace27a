"""Rows and tables of a report, as plain values."""

from typing import Any

from withheld.score.wilson import Share


def row(name: str, part: Share, aim: str = "") -> dict[str, Any]:
    """K of n with its interval; `aim`: what it is to reach, in words."""
    low, high = part.interval
    return {"row": name, "k": part.k, "n": part.n, "low": low, "high": high} | ({"aim": aim} if aim else {})


def table(title: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Rows under a title."""
    return {"title": title, "rows": rows}

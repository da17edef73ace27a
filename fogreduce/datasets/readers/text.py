"""Text as laboratories write it: what is a number, and where a line ends."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?")


def number_in(text: str, decimal: str = ".") -> float | None:
    """The number that a field holds, spaces about it allowed; None where it is none.

    ASCII digits, a decimal mark, an exponent: not what else Python takes for a number (``1_0``, digits of
    other scripts, ``nan``, ``infinity``).
    """
    text = text.strip(" \t")
    if decimal != ".":
        text = text.replace(decimal, ".") if "." not in text else "none"
    if not _NUMBER.fullmatch(text):
        return None
    value = float(text)
    return value if abs(value) != float("inf") else None

"""Shares with their uncertainty."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Share:
    """k of n, with Wilson's 95 % interval (Wilson 1927)."""

    k: int
    n: int

    @property
    def value(self) -> float | None:
        """K / n; None of none."""
        return self.k / self.n if self.n else None

    @property
    def interval(self) -> tuple[float, float]:
        """Low and high end; (0, 1) of none."""
        if self.n == 0:
            return (0.0, 1.0)
        z = 1.959963984540054
        p, n = self.k / self.n, self.n
        centre = (p + z * z / (2 * n)) / (1 + z * z / n)
        half = z / (1 + z * z / n) * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
        return (float(max(centre - half, 0.0)), float(min(centre + half, 1.0)))

    def text(self) -> str:
        """For a table: `k of n  (low-high %)`."""
        if self.n == 0:
            return "0 of 0"
        low, high = self.interval
        return f"{self.k} of {self.n} ({100 * low:.1f}-{100 * high:.1f} %)"


def share(flags: list[bool]) -> Share:
    """Of a list of judgements."""
    return Share(sum(flags), len(flags))

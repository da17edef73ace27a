"""What a statistic of the full-rate stream says for an effect: one shape for all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

_CONSISTENT = 3.0  # standard deviations within which two sizes are one


@dataclass(frozen=True)
class Finding:
    """An effect, or something unknown, held against one statistic of the full-rate stream.

    Attributes
    ----------
    effect : str
        A name of the catalogue; ``unknown`` otherwise.
    channels, runs : tuples of str
    log_b : float
        ln of its evidence over that of nothing more.
    snr2 : float
        Twice the gain in ln likelihood.
    parameters : mapping
        Name -> (value, std); std None where it has none.
    share : float
        Prior share of the effect's name.
    domain : str
        The statistic: ``level``, ``lines``, ``correlation``, ``missing``, ``outliers``, ``repeats``,
        ``codes``,
        ``stamps``.
    stage, feature : str
        The contract's words for where it shows.
    degrees : int
        Numbers that were free, for the place's significance.
    process : (kind, size) or None
        Of a random process of the catalogue: what it adds to the noise.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    log_b: float
    snr2: float
    parameters: Mapping[str, tuple[Any, Any]]
    share: float
    domain: str
    stage: str
    feature: str
    degrees: int = 1
    process: tuple[str, float] | None = None

    def joined_to(self, slow: Finding) -> Finding:
        """A random process that the spectrum shows, and block means as well: both their evidence.

        Block means that show less of it contradict the spectrum; what they show more may be others' doing.
        """
        assert self.process is not None
        name = next(iter(self.parameters))
        (full_rate, fast_std), (other, other_std) = self.parameters[name], slow.parameters[name]
        error = float(np.hypot(fast_std / full_rate, other_std / other))
        apart = float(np.log(other / full_rate)) / error
        against = 0.5 * min(apart, 0.0) ** 2
        size, std = full_rate, fast_std
        if abs(apart) < _CONSISTENT:
            weights = np.array([fast_std, other_std]) ** -2.0
            size = float(weights @ [full_rate, other] / weights.sum())
            std = float(weights.sum() ** -0.5)
        return replace(
            self,
            log_b=self.log_b + max(slow.log_b, 0.0) - against,
            snr2=self.snr2 + slow.snr2,
            parameters={name: (size, std)},
            process=(self.process[0], size),
        )

    @property
    def catalogued(self) -> bool:
        """Whether the catalogue has it."""
        return self.effect != "unknown"

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """Effect, channels, runs, frequency of a line; as a candidate's."""
        hz = self.parameters.get("frequency_hz")
        return self.effect, self.channels, self.runs, "" if hz is None else f"{hz[0]:.6g} Hz"


def joined(full_rate: Sequence[Finding], slow: Sequence[Finding]) -> list[Finding]:
    """Findings of the full rate and processes of block means, a process that both show as one."""
    shown = {f.key: f for f in full_rate if f.process is not None and f.log_b > 0.0}
    out = [f for f in full_rate if f.process is None]
    mine = {f.key: f for f in slow}
    for f in slow:
        out.append(shown[f.key].joined_to(f) if f.catalogued and f.key in shown else f)
    return out + [f for key, f in shown.items() if key not in mine]

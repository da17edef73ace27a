"""What a statistic of the full-rate stream says for an effect: one shape for all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


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

    @property
    def known(self) -> bool:
        """Whether the catalogue has it."""
        return self.effect != "unknown"

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """Effect, channels, runs, frequency of a line; as a candidate's."""
        hz = self.parameters.get("frequency_hz")
        return self.effect, self.channels, self.runs, "" if hz is None else f"{hz[0]:.6g} Hz"

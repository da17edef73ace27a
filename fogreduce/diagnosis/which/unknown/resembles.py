"""What is unknown has kin: the effects whose shapes come nearest, and how much of it each would close."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.evidence import Fit, WhitenedResidual
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.where.places import Place

Array = NDArray[np.float64]

_MOST = 3  # effects named for each place
_ALIKE = 1e-8  # of the largest eigenvalue: what is less is the same column again


@dataclass(frozen=True)
class Resemblance:
    """An effect that comes near.

    Attributes
    ----------
    effect : str
    channels, runs : tuples of str
    closes, std : float
        The share of what is unknown there that it would close, of squared signal-to-noise ratios.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    closes: float
    std: float

    def document(self) -> dict[str, object]:
        """As a diagnosis has it."""
        return {
            "effect": self.effect,
            "channels": list(self.channels),
            "runs": list(self.runs),
            "closes": round(self.closes, 4),
            "std": round(self.std, 4),
        }


def resembling(
    residual: WhitenedResidual,
    candidates: Iterable[Candidate],
    findings: Sequence[Finding],
    unknown: Sequence[Place],
) -> list[Resemblance]:
    """Effects that come nearest to what is unknown, place by place, the one that closes most first.

    Parameters
    ----------
    residual : WhitenedResidual
        What is left beside the causes, and its metric.
    candidates : of the catalogue
    findings : of the full rate
    unknown : places of it
    """
    found: list[Resemblance] = []
    by_channels: dict[tuple[str, ...], list[Place]] = {}
    for place in unknown:
        by_channels.setdefault(place.channels, []).append(place)
    candidates_by_rank = list(candidates)
    for channels, places in by_channels.items():
        families = [p.family for p in places if p.family is not None]
        if families:
            found += _slow(residual, [c for c in candidates_by_rank if c.channels == channels], families)
        else:
            found += _full_rate([f for f in findings if f.channels == channels and f.catalogued], places)
    return found


def _slow(
    residual: WhitenedResidual, candidates: Sequence[Candidate], families: Sequence[Candidate]
) -> list[Resemblance]:
    """Of effects in block means: what each takes of all that its best columns and the families show."""
    rows = len(residual.y)
    wide = np.column_stack([_whole(f, 0, rows) for f in families])
    best: dict[str, tuple[float, Resemblance]] = {}
    for fit in sorted((residual.fit(c) for c in candidates), key=lambda fit: -fit.q)[: 4 * _MOST]:
        c = fit.candidate
        gap = _squared(residual, np.column_stack([wide, _whole(c, fit.best, rows)]))
        one = Resemblance(c.effect, c.channels, c.runs, *_share(fit, gap))
        # a place of its own is a number: of effects that close as much, that with fewer
        if c.effect not in best or fit.log_b > best[c.effect][0]:
            best[c.effect] = (fit.log_b, one)
    ranked = sorted(best.values(), key=lambda pair: -pair[0])
    return [one for _, one in ranked[:_MOST] if one.closes > 2.0 * one.std]


def _share(fit: Fit, gap: float) -> tuple[float, float]:
    """Share of a squared gap that a fit takes, and its standard deviation.

    What is left, of squared length (1 - share) gap, moves with noise by twice its length.
    """
    numbers = fit.candidate.columns.shape[2]
    share = float(np.clip((fit.q - numbers) / max(gap - numbers, 1e-9), 0.0, 1.0))
    error = np.sqrt(4.0 * max(1.0 - share, 0.0) * gap + 2.0 * numbers) / max(gap, 1e-9)
    return share, float(error)


def _full_rate(candidates_by_rank: Sequence[Finding], places: Sequence[Place]) -> list[Resemblance]:
    """Of statistics of the full rate: what an effect takes of what shows at the same channels."""
    gap = max(p.q for p in places)
    near = sorted((f for f in candidates_by_rank if f.snr2 > 0.0), key=lambda f: -f.snr2)[:_MOST]
    out = []
    for f in near:
        share = float(np.clip(f.snr2 / max(gap, 1e-9), 0.0, 1.0))
        error = float(np.sqrt(4.0 * (1.0 - share) * gap + 2.0) / max(gap, 1e-9))
        if share > 2.0 * error:
            out.append(Resemblance(f.effect, f.channels, f.runs, share, error))
    return out


def _whole(c: Candidate, point: int, rows: int) -> Array:
    """Whitened columns (rows, k) at a point of a candidate's grid."""
    out = np.zeros((rows, c.columns.shape[2]))
    out[c.rows] = c.columns[:, point]
    return out


def _squared(residual: WhitenedResidual, columns: Array) -> float:
    """Squared deviates of what is left over the span of columns."""
    gram = residual.metric.gram(columns, columns)
    size = np.sqrt(np.diag(gram) + 1e-300)
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    some = values > _ALIKE * values[-1]
    b = residual.metric.gram(columns, residual.y[:, None])[:, 0] / size
    return float(np.sum((vectors[:, some].T @ b) ** 2 / values[some]))

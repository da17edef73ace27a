"""Candidates' columns as one linear regression: their Gram matrix, and any set's evidence in closed form.

With the stated uncertainties marginalised, ``G = X' S^-1 X`` and ``b = X' S^-1 y``. A set of columns with
normal amplitudes of variances D has, over nothing,

    ln B = -1/2 ln |1 + D^1/2 G D^1/2| + 1/2 b' C b,    C = (D^-1 + G)^-1,

and beside it a further block of columns sees ``G - G C G`` and ``b - G C b``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.hierarchy import Kind
from fogreduce.diagnosis.inference.noise_model import Metric

Array = NDArray[np.float64]
Index = NDArray[np.intp]

#: Of a column's own square: what stated uncertainties leave of it, below which it is not seen at all.
_SEEN = 1e-9


@dataclass(frozen=True)
class Option:
    """One way in which an entry may be there: a point of a candidate's grid.

    Attributes
    ----------
    entry : int
        The effect at its place.
    candidate : Candidate
    point : int
    columns : (k,) array of int
        In the regression.
    log_weight : float
        Ln share of the entry's prior that the point has.
    variances : (L, k) array
        Of the amplitudes, at each scale of the size; empty for what has no amplitude.
    log_scales : (L,) array
        Ln weights of the scales.
    """

    entry: int
    candidate: Candidate
    point: int
    columns: Index
    log_weight: float
    variances: Array
    log_scales: Array

    @property
    def fixed(self) -> bool:
        """Whether it has no amplitude."""
        return self.candidate.fixed


@dataclass(frozen=True)
class Entry:
    """An effect at a place: its kind, and what names it (effect, channels, runs, other gyro)."""

    kind: Kind
    key: tuple[str, tuple[str, ...], tuple[str, ...], str]


@dataclass(frozen=True)
class Alike:
    """Options that are worked out together.

    Their numbers (m,), columns (m, k), variances (m, L, k), ln weights (m, L), the sign that a positive
    parameter asks for (m,), 0 where either may be, and whether they have no amplitude.
    """

    numbers: Index
    columns: Index
    variances: Array
    weights: Array
    sign: Array
    fixed: bool


@dataclass(frozen=True)
class Regression:
    """Gram matrix (P, P) and products with the residual (P,) of all options' columns."""

    gram: Array
    b: Array
    options: Sequence[Option]
    entries: Sequence[Entry]

    @classmethod
    def of(
        cls, metric: Metric, y: Array, columns: Array, options: Sequence[Option], entries: Sequence[Entry]
    ) -> Regression:
        """From whitened columns (rows, P) and residual (rows,)."""
        gram = metric.gram(columns, columns)
        # what is not seen must not be divided by
        gram[np.diag_indices(len(gram))] += _SEEN * np.sum(columns**2, axis=0) + 1e-30
        return cls(gram, metric.gram(columns, y[:, None])[:, 0], options, entries)

    @cached_property
    def of_entry(self) -> dict[int, list[int]]:
        """Numbers of the options of each entry that has any."""
        found: dict[int, list[int]] = {}
        for number, option in enumerate(self.options):
            found.setdefault(option.entry, []).append(number)
        return found

    @cached_property
    def alike(self) -> list[Alike]:
        """All options, those of as many columns and scales together."""
        return self._together(range(len(self.options)))

    @cached_property
    def alike_of(self) -> dict[int, list[Alike]]:
        """The same of each entry's options alone."""
        return {entry: self._together(numbers) for entry, numbers in self.of_entry.items()}

    def _together(self, chosen: Iterable[int]) -> list[Alike]:
        groups: dict[tuple[int, int, bool], list[int]] = {}
        for number in chosen:
            o = self.options[number]
            groups.setdefault((len(o.columns), len(o.log_scales), o.fixed), []).append(number)
        out = []
        for (_, _, fixed), numbers in groups.items():
            here = [self.options[number] for number in numbers]
            weights = np.stack([o.log_scales + o.log_weight for o in here])
            columns, sizes = np.stack([o.columns for o in here]), np.stack([o.variances for o in here])
            sign = np.array([o.candidate.positive * np.sign(o.candidate.steps[o.point, 0]) for o in here])
            out.append(Alike(np.array(numbers), columns, sizes, weights, sign, fixed))
        return out


@dataclass(frozen=True)
class Member:
    """An option in a set, at one scale of its size; `spread`: ln of all scales' evidence over that one's."""

    option: int
    scale: int
    spread: float = 0.0


@dataclass(frozen=True)
class Fitted:
    """A set's amplitudes.

    Attributes
    ----------
    columns : (s,) array of int
        Of its members with an amplitude.
    mean, covariance : (s,), (s, s) arrays
        Posterior of the amplitudes.
    b : (P,) array
        Products with the residual less the members without an amplitude.
    log_b : float
        Ln evidence over nothing, weights of points and scales in it.
    """

    columns: Index
    mean: Array
    covariance: Array
    b: Array
    log_b: float


def fitted(regression: Regression, members: Sequence[Member]) -> Fitted:
    """Amplitudes and evidence of a set."""
    options = [regression.options[m.option] for m in members]
    exact = [o.columns[0] for o in options if o.fixed]
    free = [(o, m) for o, m in zip(options, members, strict=True) if not o.fixed]
    b, log_b = regression.b, 0.0
    if exact:
        taken = regression.gram[:, exact].sum(axis=1)
        log_b += float(b[exact].sum() - 0.5 * taken[exact].sum())
        b = b - taken
    columns: Index = np.array([c for o, _ in free for c in o.columns], np.intp)
    variance = np.array([v for o, m in free for v in o.variances[m.scale]])
    for option, member in zip(options, members, strict=True):
        log_b += option.log_weight + float(option.log_scales[member.scale]) + member.spread
    if not columns.size:
        return Fitted(columns, np.zeros(0), np.zeros((0, 0)), b, log_b)
    size = np.sqrt(variance)
    whole = np.eye(len(size)) + regression.gram[np.ix_(columns, columns)] * np.outer(size, size)
    half, log_size = _inverse_root(whole)
    half = half * size
    covariance: Array = half.T @ half
    mean = covariance @ b[columns]
    log_b += 0.5 * float(b[columns] @ mean) - 0.5 * log_size
    return Fitted(columns, mean, covariance, b, log_b)


def _inverse_root(whole: Array) -> tuple[Array, float]:
    """H with H' H = W^-1, and ln |W|, of a matrix W (s, s) none of whose eigenvalues is below 1."""
    try:
        root = np.linalg.cholesky(whole)
        return np.linalg.inv(root), 2.0 * float(np.sum(np.log(np.diag(root))))
    except np.linalg.LinAlgError:
        # columns that are all but alike, at gross sizes: rounding has made an eigenvalue negative
        values, vectors = np.linalg.eigh(whole)
        values = np.maximum(values, 1.0)
        return vectors.T / np.sqrt(values)[:, None], float(np.sum(np.log(values)))


def worths(regression: Regression, members: Sequence[Member], fit: Fitted) -> list[float]:
    """Ln evidence of each member beside the others, at its scale: the ratio of its amplitudes' densities at
    nothing, before and after the data (Savage and Dickey); 0 for what has no amplitude.
    """
    out, start = [], 0
    for member in members:
        option = regression.options[member.option]
        if option.fixed:
            out.append(0.0)
            continue
        k = len(option.columns)
        mine = slice(start, start + k)
        start += k
        covariance, mean = fit.covariance[mine, mine], fit.mean[mine]
        variance = option.variances[member.scale]
        _, size = np.linalg.slogdet(covariance)
        along = float(mean @ np.linalg.solve(covariance, mean))
        log_evidence = option.log_weight + float(option.log_scales[member.scale]) + member.spread
        out.append(log_evidence + 0.5 * (along + float(size) - float(np.sum(np.log(variance)))))
    return out


@dataclass(frozen=True)
class Additions:
    """What each option would add to a set: ln evidence (options,), all scales in it; its best scale; its
    ln evidence over all scales less that at the best.
    """

    gain: Array
    scale: Index
    spread: Array


def additions(regression: Regression, fit: Fitted, entry: int | None = None) -> Additions:
    """Every option beside a set; with `entry`, the options of that one alone, and -inf for others."""
    count = len(regression.options)
    gain, scale, spread = np.full(count, -np.inf), np.zeros(count, np.intp), np.zeros(count)
    for here in regression.alike if entry is None else regression.alike_of[entry]:
        columns = here.columns
        onto = regression.gram[columns[:, :, None], fit.columns]  # (m, k, s)
        gram = regression.gram[columns[:, :, None], columns[:, None, :]]
        gram = gram - (onto @ fit.covariance) @ onto.transpose(0, 2, 1)
        b = fit.b[columns] - onto @ fit.mean
        if here.fixed:
            gain[here.numbers] = b[:, 0] - 0.5 * gram[:, 0, 0] + here.weights[:, 0]
            continue
        logs = _scale_evidence(gram, b, here.variances) + here.weights
        best = np.argmax(logs, axis=1)
        top = logs[np.arange(len(logs)), best]
        whole = top + np.log(np.sum(np.exp(logs - top[:, None]), axis=1))
        wrong = (here.sign * b[:, 0] < 0.0) | _too_large(gram, b, here.variances)
        gain[here.numbers] = np.where(wrong, -np.inf, whole)
        scale[here.numbers], spread[here.numbers] = best, whole - top
    return Additions(gain, scale, spread)


def _too_large(gram: Array, b: Array, variances: Array) -> NDArray[np.bool_]:
    """Whether amplitudes (m,) are larger than is believed, at the widest scale."""
    unit = np.sqrt(variances[:, -1])
    whole = gram * unit[:, :, None] * unit[:, None, :] + np.eye(gram.shape[1])
    found = np.linalg.solve(whole, (b * unit)[:, :, None])[:, :, 0]
    return np.asarray(np.sum(found**2, axis=1) > priors.LARGEST**2, np.bool_)


def _scale_evidence(gram: Array, b: Array, variances: Array) -> Array:
    """Ln evidence (m, L) of blocks of columns, gram (m, k, k) and b (m, k), at each scale of their size."""
    # scales differ by one factor alike for all columns of a block
    unit = np.sqrt(variances[:, 0] / variances[:, 0, :1])
    if gram.shape[1] == 1:
        size, grown = variances[:, :, 0], variances[:, :, 0] * np.maximum(gram[:, :, 0], 0.0)
        return np.asarray(0.5 * (size * b**2 / (1.0 + grown) - np.log1p(grown)))
    values, vectors = np.linalg.eigh(gram * unit[:, :, None] * unit[:, None, :])
    along = np.einsum("mkl,mk->ml", vectors, b * unit)
    size = variances[:, :, :1]
    grown = np.maximum(values, 0.0)[:, None, :] * size
    return np.asarray(0.5 * np.sum(size * along[:, None, :] ** 2 / (1.0 + grown) - np.log1p(grown), axis=2))

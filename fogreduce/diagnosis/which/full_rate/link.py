"""What the link and the converter's codes say: missing and spurious answers, repeats, bits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.full_rate import MOST_BITS, NORMAL, FullRate
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.physics.special import normal_deviate

Array = NDArray[np.float64]

#: Chance that a healthy link loses or spoils a sample. The contract does not state it.
HEALTHY_FAULT = 1e-6
_FRACTIONS = np.geomspace(1e-6, 0.5, 41)
_DOUBLE = 0.1  # prior of an unknown cause of what an effect of the catalogue does
_SPIKE_REACH = 2.0**30
_FINE = 0.5  # counts of noise from which on neighbours that are equal by chance are few
_MANY_STEPS = 8.0  # whose median tells their scatter
_AT_THE_END = 2.0  # records that the end of a capture lacks by the rounding of its length


def share_evidence(hits: float, trials: float, base: float) -> tuple[float, float, float]:
    """Ln B of a further share of hits, even in its logarithm, against chance; twice the gain; best share.

    Parameters
    ----------
    hits, trials : float
    base : float
        Chance of a hit when nothing is wrong.
    """
    if trials <= 0.0:
        return 0.0, 0.0, 0.0

    def log_l(p: Array) -> Array:
        return hits * np.log(p) + (trials - hits) * np.log1p(-p)

    chance = np.array(min(max(base, 1e-12), 0.5))
    logs = log_l(_FRACTIONS + (1.0 - _FRACTIONS) * chance) - log_l(chance)
    best = min(max((hits / trials - float(chance)) / (1.0 - float(chance)), 0.0), 0.999)
    gain = 0.0
    if best > 0.0:
        gain = float(log_l(np.array(best + (1.0 - best) * chance)) - log_l(chance))
    return float(log_mean_exp(logs)), 2.0 * gain, best


def link_findings(
    runs: Sequence[FullRate], allowed: frozenset[str], noise_counts: Array
) -> Iterator[Finding]:
    """Findings at every gyro.

    Parameters
    ----------
    runs : statistics
    allowed : names of effects
    noise_counts : (R, n) array
        White noise of a sample in counts, in each run.
    """
    n = noise_counts.shape[1]
    yield from _lost_records(runs, n)
    for i in range(n):
        name, share = (gyro_name(i),), 1.0 / n
        samples = sum(float(run.samples[i]) for run in runs)
        missing = sum(float(run.missing[i]) for run in runs)
        spurious = sum(float(run.spurious[i]) for run in runs)
        trials = samples + missing + spurious
        for effect, hits, feature, extra in (
            ("dropouts", missing, "missing", 0.0),
            ("spikes", spurious, "outliers", _reach(runs, i)),
        ):
            log_b, snr2, value = share_evidence(hits, trials, HEALTHY_FAULT)
            std = np.sqrt(max(hits, 1.0)) / trials if trials else 0.0
            parameters = {"fraction": (value, std)}
            if effect in allowed:
                yield Finding(
                    effect, name, ("*",), log_b + extra, snr2, parameters, share, feature, "link", feature
                )
            # answers that are missing are just what dropouts are
            other = share * (_DOUBLE if effect == "dropouts" and effect in allowed else 1.0)
            yield Finding("unknown", name, ("*",), log_b, snr2, {}, other, feature, "link", feature)
        bits = zero_bits(runs, i)
        # where noise is less than half a step, equal neighbours are no repeats
        awake = [
            (run, noise)
            for run, noise in zip(runs, noise_counts[:, i].tolist(), strict=True)
            if not run.at_rest[i] and noise > _FINE * 2.0**bits
        ]
        pairs = sum(float(run.pairs[i]) for run, _ in awake)
        repeats = sum(float(run.repeats[i]) for run, _ in awake)
        equal = sum(
            float(run.pairs[i]) * _equal(run.scatter[i] / 2.0**bits, noise / 2.0**bits)
            for run, noise in awake
        )
        chance = equal / max(pairs, 1.0)
        log_b, snr2, value = share_evidence(repeats, pairs, chance)
        std = np.sqrt(max(repeats, 1.0)) / max(pairs, 1.0)
        effect = "stuck_samples" if "stuck_samples" in allowed else "unknown"
        given = {"fraction": (value, std)} if effect != "unknown" else {}
        yield Finding(effect, name, ("*",), log_b, snr2, given, share, "repeats", "link", "repeats")
        if bits:
            effect = "lost_bits" if "lost_bits" in allowed else "unknown"
            gain = samples * bits * np.log(2.0)
            bit: dict[str, tuple[int, float]] = {"bits": (bits, 0.0)} if effect != "unknown" else {}
            yield Finding(
                effect,
                name,
                ("*",),
                gain - np.log(MOST_BITS),
                2.0 * gain,
                bit,
                share,
                "codes",
                "electronics",
                "codes",
            )


def _equal(scatter: float, noise: float) -> float:
    """Chance that neighbours are equal, from their differences' scatter and their noise, in steps.

    A filter makes neighbours alike; where steps are coarse, their scatter is known by the noise alone.
    """
    between = np.sqrt(2.0) * noise
    if scatter > _MANY_STEPS:
        # the scatter is told from the median of the differences that are not 0
        equal = 1.0 / (scatter * np.sqrt(2.0 * np.pi))
        between = scatter / NORMAL / normal_deviate(0.75 + 0.25 * equal)
    return float(min(1.0 / (between * np.sqrt(2.0 * np.pi)), 0.5))


def _lost_records(runs: Sequence[FullRate], n: int) -> Iterator[Finding]:
    """Records that never arrived, in each run that lacks some: no gyro's doing."""
    for run in runs:
        lost = max(float(run.lost) - _AT_THE_END, 0.0)
        log_b, snr2, _ = share_evidence(lost, float(run.expected), HEALTHY_FAULT)
        gyros = tuple(gyro_name(i) for i in range(n))
        yield Finding(
            "unknown",
            gyros,
            (run.run_id,),
            log_b,
            snr2,
            {},
            1.0 / len(runs),
            f"records of {run.run_id}",
            "link",
            "missing",
        )


def zero_bits(runs: Sequence[FullRate], i: int) -> int:
    """How many lowest bits of gyro i's counts are always 0: in all but a few counts, and in more than by
    chance.
    """
    total = sum(float(run.ends[i, 0]) for run in runs)
    if total < 32:
        return 0
    shares = [sum(float(run.ends[i, m]) for run in runs) / total for m in range(MOST_BITS + 1)]
    found = [m for m in range(1, MOST_BITS + 1) if shares[m] > 0.95]
    return max(found, default=0)


def _reach(runs: Sequence[FullRate], i: int) -> float:
    """Ln likelihood of spurious counts as even over +-2^30 against even in their logarithm."""
    counts = np.concatenate([np.abs(run.spurious_counts[i].astype(float)) for run in runs])
    if not counts.size:
        return 0.0
    even = np.where(counts <= _SPIKE_REACH, -np.log(2.0 * _SPIKE_REACH), -40.0)
    in_log = -np.log(2.0 * np.maximum(counts, 1.0) * np.log(2.0**31))
    return float(np.clip(np.sum(even - in_log), -50.0, 5.0))

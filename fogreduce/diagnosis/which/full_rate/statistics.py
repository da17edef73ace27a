"""The full rate's side of the search: levels, lines, correlations, link, beside the causes found already."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.constant import dead_findings
from fogreduce.diagnosis.observe.data import Data
from fogreduce.diagnosis.observe.run_noise import run_level_findings
from fogreduce.diagnosis.which.full_rate.converter import converter_findings
from fogreduce.diagnosis.which.full_rate.correlation import correlation_findings
from fogreduce.diagnosis.which.full_rate.line import Line
from fogreduce.diagnosis.which.full_rate.link import link_findings
from fogreduce.diagnosis.which.full_rate.spectrum import DRIFTS, level_findings, levels
from fogreduce.diagnosis.which.full_rate.stamps import stamp_findings

Array = NDArray[np.float64]

_WIRING = ("channel_swap", "polarity_error", "rotation_sense", "start_offset", "saturation")
_UNKNOWN_SHARE = 0.3  # of what is unknown of lines, mixtures have


class FullRateStatistics:
    """Findings of the full rate.

    Parameters
    ----------
    data : Data
    allowed : names of effects

    Attributes
    ----------
    level : (R, n) array
        White noise at low frequencies over that of the record: what block means scatter with.
    """

    def __init__(self, data: Data, allowed: frozenset[str]) -> None:
        self.data, self.allowed = data, allowed
        self.facts = [one.facts for one in data.inputs]
        n = data.n
        self.link = [
            *link_findings(data.full, allowed, data.noise_counts()),
            *stamp_findings({run.run_id: run.stamps for run in data.full}, allowed),
            *converter_findings(data.codes, n, allowed, self._step()),
            *dead_findings(data.constant, len(data.inputs), n),
            *run_level_findings(data.full, data.inputs, data.run_level, allowed),
        ]
        bits, colour = data.bits.astype(float), self._colour()
        plain = levels(data.full, self.facts, data.stated_white, [[]] * n, bits, colour, data.run_level)
        whole = np.ones(n) if plain is None else np.sqrt(np.median(plain.ratio, axis=1))
        self.whole = np.clip(np.where(whole > 0, whole, 1.0), 0.05, 1e3) * self._rounding() * data.run_level
        self.lines = [_line_finding(line, allowed) for line in data.lines]
        spoiled = [[line.hz for line in data.lines if line.taken]] * n
        self.levels = levels(data.full, self.facts, data.stated_white, spoiled, bits, colour, data.run_level)
        self.repeat_shape = [self._shape_of_repeats(i) for i in range(n)]
        self.level = self._low_level()
        self._cache: dict[object, list[Finding]] = {}

    def _colour(self) -> tuple[Array, Array]:
        """Flicker and random walk as the record states them, (n,) each."""
        noise = self.data.inputs[0].record.stated_noise
        return np.array(noise.bias_instability_deg_h), np.array(noise.rate_random_walk_deg_h_sqrt_h)

    def _step(self) -> Array:
        """Widest of each gyro's converter, the bits that are always 0 left out, (n,) [raw unit]."""
        return max(one.least_count for one in self.facts) * 2.0 ** self.data.bits.astype(float)

    def _rounding(self) -> Array:
        """Noise with the converter's rounding over noise without, (R, n): levels are over what both make."""
        counts = self.data.noise_counts()
        return np.sqrt(1.0 + 4.0 ** self.data.bits.astype(float) / 12.0 / counts**2)

    def _low_level(self) -> Array:
        """Level of the lowest quarter of the spectrum in each run (R, n); a filter leaves block means as they
        are.
        """
        out, lv = np.ones(self.data.n), self.levels
        for i in range(self.data.n if lv is not None else 0):
            assert lv is not None
            keep = lv.keep[i] & lv.lowest & (lv.pieces[i] > 0)
            part = lv.ratio[i] / self.repeat_shape[i]
            rivals = frozenset({"low_pass", "angle_random_walk", *DRIFTS})
            found = level_findings(lv, i, rivals, self.repeat_shape[i], False)
            best = max(found, key=lambda f: f.log_b, default=None)
            if best is not None and best.process is not None and best.log_b > 3.0:
                part = part / lv.with_process(*best.process, i)
            if keep.any():
                white = np.average(lv.less_drift(part, i)[keep], weights=lv.pieces[i, keep])
                out[i] = float(np.sqrt(max(white, 1e-4)))
            if best is not None and best.effect == "low_pass" and best.log_b > 3.0:
                out[i] = 1.0
        return np.clip(out, 0.2, 1e3) * self._rounding() * self.data.run_level

    def _shape_of_repeats(self, i: int) -> Array:
        """Shape of the spectrum of white noise whose samples repeat with the share found: q^|k|
        correlated.
        """
        size = 0 if self.levels is None else self.levels.ratio.shape[1]
        found = [f for f in self.link if f.domain == "repeats" and f.channels == (f"gyro{i + 1}",)]
        q = 0.0
        if found and found[0].snr2 > 16.0:
            pairs = sum(float(run.pairs[i]) for run in self.data.full)
            repeats = sum(float(run.repeats[i]) for run in self.data.full)
            q = min(repeats / max(pairs, 1.0), 0.95)
        if q == 0.0 or self.levels is None:
            return np.ones(size)
        turn = 2.0 * np.pi * self.levels.frequency
        shape: Array = (1.0 - q * q) / (1.0 + q * q - 2.0 * q * np.cos(turn))
        return shape

    def findings(self, causes: Sequence[Cause]) -> list[Finding]:
        """What may be added to the causes."""
        mine = [c.finding for c in causes if c.finding is not None]
        # a column that holds another gyro has that one's noise; a clipped one repeats its limit, bits and all
        clipped = {name for c in causes if c.effect == "saturation" for name in c.channels}
        moved = {
            name for c in causes if c.effect == "channel_swap" for name in (*c.channels, c.key[3])
        } | clipped
        # beside a wrong sense or wiring the departures that codes are held against are no noise
        wired = any(c.effect in _WIRING for c in causes)
        key = repr((wired, sorted(moved), sorted(clipped))) + repr(
            sorted((f.domain, f.channels, f.effect, str(f.parameters)) for f in mine)
        )
        if key not in self._cache:
            self._cache[key] = [
                f
                for f in self._found(mine)
                if not (f.domain.split()[0] in ("level", "repeats") and moved & set(f.channels))
                and not (f.domain == "codes" and clipped & set(f.channels))
                and not (f.domain == "converter" and wired)
            ]
        return self._cache[key]

    def _found(self, mine: Sequence[Finding]) -> list[Finding]:
        taken = {(f.domain, f.channels) for f in mine}
        out = [f for f in self.link if (f.domain, f.channels) not in taken]
        found = {f.key for f in mine}
        out += [f for f in self.lines if f.key not in found]
        if self.levels is None:
            return out
        for i in range(self.data.n):
            here = [f for f in mine if f.domain == "level" and f.channels == (f"gyro{i + 1}",)]
            shape = self.repeat_shape[i].copy()
            for f in here:
                if f.effect == "low_pass":
                    tau = float(f.parameters["time_constant_ms"][0])
                    shape *= self.levels.low_passed(tau, i)
            for f in mine:
                if f.process is not None and f.channels == (f"gyro{i + 1}",):
                    shape *= self.levels.with_process(*f.process, i)
            free = any(f.effect == "angle_random_walk" for f in here)
            named = {f.effect for f in here}
            allowed = self.allowed - named
            filtered = "low_pass" in named
            for f in level_findings(self.levels, i, allowed, shape, free, filtered):
                if not (f.effect == "unknown" and f.feature == "white" and (free or filtered)):
                    out.append(f)
        if not any(f.domain == "correlation" for f in mine):
            out += list(correlation_findings(self.levels, self.allowed))
        return out


def _line_finding(line: Line, allowed: frozenset[str]) -> Finding:
    """A line as what an effect of the catalogue does, or as unknown."""
    table = line.channels == ("table",)
    effect = "base_motion" if table else "periodic_interference"
    known = line.catalogued and effect in allowed
    parameters: dict[str, tuple[Any, Any]] = {
        "deg_h": (line.deg_h, line.std),
        "frequency_hz": (line.hz, line.hz_std),
    }
    if line.axis is not None:
        parameters["axis"] = (list(line.axis), None)
    return Finding(
        effect if known else "unknown",
        line.channels,
        line.runs,
        line.log_b,
        2.0 * line.gain,
        parameters,
        line.share * (1.0 if line.catalogued else _UNKNOWN_SHARE),
        "lines" if line.runs == ("*",) else "lines of " + " ".join(line.runs),
        "table" if table else "noise",
        "line",
        line.degrees,
    )

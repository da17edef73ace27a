"""All outcomes of a study as the rows of its report."""

from collections import Counter
from itertools import pairwise
from typing import Any

import numpy as np

from withheld.effects.catalogue import FULL_RATE
from withheld.score.class_tables import class_tables
from withheld.score.judge import OUTSIDE, Outcome
from withheld.score.rows import row, table
from withheld.score.wilson import Share, share
from withheld.study.classes import CLASSES
from withheld.study.protocol import Thresholds

# Edges of bands of signal-to-noise ratio; the last is open.
BANDS = (0.0, 3.0, 5.0, 8.0, 15.0, np.inf)
FATES = ("flagged_in_place", "flagged_elsewhere", "misattributed", "indistinguishable", "missed")


def band_name(low: float, high: float) -> str:
    """`5 to 8`; `15 and up`."""
    return f"{low:g} and up" if np.isinf(high) else f"{low:g} to {high:g}"


def bands(outcomes: list[Outcome]) -> list[tuple[str, list[Outcome]]]:
    """Outcomes by the SNR of their faintest effect."""
    return [
        (band_name(low, high), [o for o in outcomes if o.snr is not None and low <= o.snr < high])
        for low, high in pairwise(BANDS)
    ]


def clairvoyant_share(group: list[Outcome], thresholds: Thresholds) -> tuple[float, float]:
    """What somebody who knows the waveforms would reach: (names a gap, names the cause), expected shares.

    A matched filter's output is normal with mean SNR; it sees a gap above `group_below`, and names the cause
    where the difference to the best rival, mean d^2 / 2 and deviation d, is positive.
    """
    from scipy.stats import norm

    seen = [float(norm.cdf((o.snr or 0.0) - thresholds.group_below)) for o in group]
    named = [s * float(norm.cdf((o.separated or 0.0) / 2.0)) for s, o in zip(seen, group, strict=True)]
    return float(np.mean(seen)), float(np.mean(named))


def _causes(title: str, outcomes: list[Outcome], thresholds: Thresholds) -> dict[str, Any]:
    """Rows for each band of SNR; beside a gap seen and a cause named, what the clairvoyant expects."""
    rows, never = [], thresholds.group_never
    for name, group in bands(outcomes):
        if not group:
            continue
        seen, named = clairvoyant_share(group, thresholds)
        apart = [o for o in group if (o.separated or 0.0) >= never]
        rows += [
            row(f"SNR {name}: a gap was seen", share([o.flagged for o in group])) | {"clairvoyant": seen},
            row(f"SNR {name}: right cause", share([bool(o.exact) for o in group])) | {"clairvoyant": named},
            row(f"SNR {name}: right cause or pure group", share([bool(o.by_group) for o in group])),
            row(
                f"SNR {name}: right cause, every rival separated by {never:g}",
                share([bool(o.exact) for o in apart]),
            ),
            row(f"SNR {name}: right place first", share([bool(o.place_right) for o in group])),
            row(f"SNR {name}: verdict explained", share([o.verdict_right for o in group])),
        ]
    return table(title, rows)


def _outside(title: str, outcomes: list[Outcome], keeps: float) -> list[dict[str, Any]]:
    """Fates in bands: of those that no catalogue rival comes near, then of all."""
    apart = [o for o in outcomes if (o.separated or 0.0) >= keeps]
    tables = []
    for name, chosen in (
        (f"{title}, separated by {keeps:g} from every rival", apart),
        (f"{title}, all", outcomes),
    ):
        rows = [
            row(f"SNR {band}: {fate.replace('_', ' ')}", share([o.fate == fate for o in group]))
            for band, group in bands(chosen)
            for fate in FATES
            if group
        ]
        tables.append(table(name, rows))
    return tables


def reliability(pairs: list[tuple[float, bool]]) -> dict[str, Any]:
    """Stated probabilities in tenths: mean stated, share right; the gap between the two, and what a
    perfectly calibrated answer of this sample size would show on average (mean absolute deviation
    of each bin, weighted).
    """
    out: dict[str, Any] = {"n": len(pairs), "bins": [], "error": None, "expected_error": None}
    if not pairs:
        return out
    stated = np.array([p for p, _ in pairs])
    right = np.array([r for _, r in pairs], dtype=float)
    place = np.minimum((stated * 10).astype(int), 9)
    error = expected = 0.0
    for b in range(10):
        inside = place == b
        if not inside.any():
            continue
        p, n = float(stated[inside].mean()), int(inside.sum())
        part = Share(int(right[inside].sum()), n)
        out["bins"].append({"stated": p, **row(f"{b / 10:.1f}", part)})
        error += abs(p - right[inside].mean()) * n
        # mean absolute value of a normal of that deviation
        expected += np.sqrt(2 / np.pi) * np.sqrt(float(np.sum(stated[inside] * (1 - stated[inside])))) / n * n
    out["error"], out["expected_error"] = float(error / len(pairs)), float(expected / len(pairs))
    return out


def _quantiles(values: list[float]) -> dict[str, Any]:
    if not values:
        return {"n": 0}
    low, middle, high = np.percentile(values, [16, 50, 84])
    return {"n": len(values), "p16": float(low), "median": float(middle), "p84": float(high)}


def summarise(outcomes: list[Outcome], thresholds: Thresholds) -> dict[str, Any]:
    """Classes first; then what the first studies had, over their own kinds of cases.

    Tables (each row k of n with its interval), reliabilities, pulls, closure, groups, time, confusions.
    """
    keeps = thresholds.stranger_keeps
    everyone, outcomes = outcomes, [o for o in outcomes if o.kind not in CLASSES]
    nothing = [o for o in outcomes if o.kind == "nothing"]
    single = [o for o in outcomes if o.kind == "single"]
    several = [o for o in outcomes if o.kind in ("pair", "triple")]
    outside = [o for o in outcomes if o.kind in OUTSIDE]
    closed = [o for o in outcomes if o.kind not in OUTSIDE]
    pulls = [p for o in outcomes for p in o.pulls]
    close = [
        (f - oracle, std, o.snr or 0.0)
        for o in outcomes
        if o.closure and o.by_group
        for f, std, oracle in [o.closure]
    ]
    groups = [o for o in single if o.group_size]
    tables = [
        table("Nothing wrong", [
            row("called a gap", share([o.flagged for o in nothing])),
            row("diagnosis of the contract's form, all cases", share([o.valid for o in everyone])),
        ]),
        _causes("One effect, eight runs", [o for o in single if o.design.startswith("eight")], thresholds),
        _causes("One effect, all designs, slow",
                [o for o in single if o.effects[0] not in FULL_RATE], thresholds),
        _causes("One effect, all designs, full rate",
                [o for o in single if o.effects[0] in FULL_RATE], thresholds),
        _causes("Two and three effects", several, thresholds),
        table("Two and three effects, each effect", [
            row("named", Share(sum(o.named or 0 for o in several), sum(len(o.effects) for o in several)))]),
        table("One effect, by design", [
            row(f"{d}: right cause or pure group",
                 share([bool(o.by_group) for o in single if o.design == d]))
            for d in sorted({o.design for o in single})]),
        *_outside("Never in the catalogue", [o for o in outside if o.kind == "stranger"], keeps),
        *_outside("Taken out of the catalogue", [o for o in outside if o.kind == "without"], keeps),
        table("Groups (one effect)", [
            row("members that belong (separation below 4)", Share(
                sum(o.group_pure or 0 for o in groups), sum(o.group_size or 0 for o in groups))),
            row("groups without a member separated by 6 or more", share([not o.impure_far for o in groups])),
            row("of at most 4 members, eight runs",
                 share([(o.group_size or 0) <= 4 for o in groups if o.design.startswith("eight")])),
            row("of at most 8 members, one run",
                 share([(o.group_size or 0) <= 8 for o in groups if o.design.startswith("one")])),
        ]),
        table("Parameters of right causes", [
            row("within 2 standard deviations", share([abs(p) < 2 for p in pulls]))]),
        table("Closure against the oracle, right causes", [
            row("within 0.03", share([abs(d) < 0.03 for d, _, _ in close])),
            row("within 0.03, SNR 20 and up", share([abs(d) < 0.03 for d, _, snr in close if snr >= 20])),
            row("within 2 of its own standard deviations",
                 share([abs(d) < 2 * max(s, 1e-9) for d, s, _ in close])),
            row("within 2 of its own standard deviations, SNR below 20",
                 share([abs(d) < 2 * max(s, 1e-9) for d, s, snr in close if snr < 20]))]),
    ]  # fmt: skip
    return {
        "cases": len(everyone),
        "kinds": dict(Counter(o.kind for o in everyone)),
        "tables": [*class_tables(everyone, thresholds), *tables],
        "clairvoyant": [
            {"band": name, "n": len(group), "seen": seen, "named": named}
            for name, group in bands(single) if group
            for seen, named in [clairvoyant_share(group, thresholds)]
        ],
        "reliability": {
            "causes, closed set": reliability([s for o in closed for s in o.stated]),
            "causes, open set": reliability([s for o in outside for s in o.stated]),
            "groups, closed set": reliability([s for o in closed for s in o.stated_group]),
            "groups, open set": reliability([s for o in outside for s in o.stated_group]),
            "a gap, all cases": reliability([o.gap for o in outcomes if o.gap]),
            "something unknown, all cases": reliability([o.unknown for o in outcomes if o.unknown]),
        },
        "pulls": _quantiles(pulls),
        "std_over_attainable": _quantiles([r for o in outcomes for r in o.attainable]),
        "closure_less_oracle": _quantiles([d for d, _, _ in close]),
        "group_size": _quantiles([float(o.group_size) for o in groups if o.group_size]),
        "seconds": _quantiles([o.seconds for o in everyone if o.seconds is not None]),
        "confusion": [
            {"truth": truth, "answer": answer, "n": n}
            for (truth, answer), n in sorted(Counter((o.effects[0] if o.effects else "nothing", o.answer)
                                                     for o in outcomes if len(o.effects) < 2).items())
        ],
    }  # fmt: skip

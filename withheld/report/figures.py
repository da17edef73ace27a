"""Figures of a study's report: each a function from scores to a Figure."""

from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from withheld.arrays import Array
from withheld.effects.catalogue import NAMES as CATALOGUE
from withheld.effects.strangers import NAMES as STRANGERS
from withheld.score.summary import BANDS, FATES, band_name
from withheld.score.wilson import Share

GROUND, INK, RULE = "#ffffff", "#22303c", "#d5dbe0"
RIGHT, GROUPED, SEEN, IDEAL, BAD = "#1f6f8b", "#7fb5c4", "#b9c4cc", "#c8553d", "#c8553d"
_FATE_COLOURS = dict(zip(FATES, ("#1f6f8b", "#7fb5c4", "#c8553d", "#e8c468", "#b9c4cc"), strict=True))
_FATE_WORDS = {
    "flagged_in_place": "flagged, right place", "flagged_elsewhere": "flagged, elsewhere",
    "misattributed": "misattributed", "indistinguishable": "indistinguishable", "missed": "missed",
}  # fmt: skip
Outcomes = list[dict[str, Any]]


def _figure(width: float, height: float, columns: int = 1) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(width, height), layout="constrained", facecolor=GROUND)
    axes = figure.subplots(1, columns, squeeze=False)[0]
    for ax in axes:
        ax.spines[["top", "right"]].set_visible(False)
        ax.spines[["left", "bottom"]].set_color(RULE)
        ax.tick_params(colors=INK, labelsize=9)
        ax.title.set_color(INK)
    return figure, list(axes)


def _in_bands(outcomes: Outcomes) -> list[tuple[str, Outcomes]]:
    """Outcomes by bands of SNR, without the empty ones."""
    parts = [
        (band_name(a, b), [o for o in outcomes if o["snr"] is not None and a <= o["snr"] < b])
        for a, b in pairwise(BANDS)
    ]
    return [(name, group) for name, group in parts if group]


def _empty(ax: Axes, text: str) -> None:
    """A panel with nothing to show says so, and shows no scale."""
    ax.text(0.5, 0.5, text, ha="center", color=INK, fontsize=9, transform=ax.transAxes)
    ax.set(xticks=[], yticks=[])


def _points(ax: Axes, x: Array, shares: list[Share], colour: str, marker: str, name: str) -> None:
    for place, part in zip(x.tolist(), shares, strict=True):
        if part.n:
            low, high = part.interval
            ax.plot([place, place], [100 * low, 100 * high], color=colour, lw=2, solid_capstyle="butt")
    seen = [(p, 100 * s.k / s.n) for p, s in zip(x.tolist(), shares, strict=True) if s.n]
    ax.plot([p for p, _ in seen], [v for _, v in seen], marker, color=colour, ms=7, label=name, mec=GROUND)


def causes_against_snr(scores: dict[str, Any]) -> Figure:
    """Gap seen, right by group, right by name, in each band of SNR, beside the clairvoyant."""
    figure, (ax,) = _figure(8.0, 4.2)
    parts = _in_bands([o for o in scores["outcomes"] if o["kind"] == "single"])
    x = np.arange(len(parts), dtype=float)
    named = (
        ("flagged", SEEN, "s", "a gap seen", -0.18),
        ("by_group", GROUPED, "D", "right cause or pure group", 0.0),
        ("exact", RIGHT, "o", "right cause", 0.18),
    )
    for field, colour, marker, name, shift in named:
        shares = [Share(sum(bool(o[field]) for o in group), len(group)) for _, group in parts]
        _points(ax, x + shift, shares, colour, marker, name)
    ideal = {row["band"]: row for row in scores["summary"]["clairvoyant"]}
    for number, (band, _) in enumerate(parts):
        for key, style in (("seen", ":"), ("named", "-")):
            if band in ideal:
                label = {"seen": "clairvoyant: gap", "named": "clairvoyant: cause"}[key]
                ax.plot(
                    [number - 0.35, number + 0.35], [100 * ideal[band][key]] * 2, style, color=IDEAL, lw=1.8,
                    label=label if band == next(iter(ideal)) else None,
                )  # fmt: skip
    ax.set_xticks(x, [f"{name}\n(n = {len(group)})" for name, group in parts])
    ax.set(xlabel="signal-to-noise ratio of the effect", ylabel="share of cases, %", ylim=(-3, 103))
    ax.set_xlim(-0.6, max(len(parts), 1) - 0.4)
    ax.set_title("One effect of the catalogue", loc="left", fontsize=11)
    ax.legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def outside_the_catalogue(scores: dict[str, Any]) -> Figure:
    """What became of effects that the diagnoser could not name, in each band of SNR."""
    figure, axes = _figure(9.5, 4.2, 2)
    for ax, kind, title in zip(
        axes, ("without", "stranger"), ("Taken out of the catalogue", "Never in the catalogue"), strict=True
    ):
        parts = _in_bands([o for o in scores["outcomes"] if o["kind"] == kind])
        base = np.zeros(len(parts))
        for fate in FATES:
            values = np.array([100 * sum(o["fate"] == fate for o in g) / len(g) for _, g in parts])
            ax.bar(
                np.arange(len(parts)), values, 0.7, bottom=base, color=_FATE_COLOURS[fate],
                label=_FATE_WORDS[fate], edgecolor=GROUND, lw=0.8,
            )  # fmt: skip
            base += values
        ax.set_xticks(np.arange(len(parts)), [f"{name}\n(n = {len(group)})" for name, group in parts])
        ax.set(xlabel="signal-to-noise ratio", ylim=(0, 100), xlim=(-0.6, max(len(parts), 1) - 0.4))
        ax.set_title(title, loc="left", fontsize=11)
    axes[0].set_ylabel("share of cases, %")
    axes[1].legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def confusion(scores: dict[str, Any]) -> Figure:
    """Truth against the effect named first, or the verdict where none is named."""
    rows = scores["summary"]["confusion"]
    order = ("nothing", *CATALOGUE, *STRANGERS, "no_gap", "partly_explained", "unexplained", "invalid")
    truths = [name for name in order if any(r["truth"] == name for r in rows)]
    answers = [name for name in order if any(r["answer"] == name for r in rows)]
    answers += sorted({r["answer"] for r in rows} - set(answers))
    matrix = np.zeros((len(truths), len(answers)))
    for r in rows:
        matrix[truths.index(r["truth"]), answers.index(r["answer"])] = r["n"]
    totals = matrix.sum(axis=1)
    figure, (ax,) = _figure(max(3.2 + 0.24 * len(answers), 6.0), 2.2 + 0.2 * len(truths))
    from matplotlib.colors import LinearSegmentedColormap

    shades = LinearSegmentedColormap.from_list("shades", [GROUND, RIGHT])
    shares = matrix / totals[:, None]
    ax.imshow(shares, cmap=shades, vmin=0, vmax=1, aspect="auto")
    for i, j in zip(*np.nonzero(matrix), strict=True):
        colour = GROUND if shares[i, j] > 0.55 else INK
        ax.text(j, i, f"{int(matrix[i, j])}", ha="center", va="center", fontsize=7, color=colour)
    ax.set_xticks(np.arange(len(answers)), [a.replace("_", " ") for a in answers], rotation=90, fontsize=8)
    ax.set_yticks(np.arange(len(truths)), [t.replace("_", " ") for t in truths], fontsize=8)
    ax.set_xticks(np.arange(len(answers) + 1) - 0.5, minor=True)
    ax.set_yticks(np.arange(len(truths) + 1) - 0.5, minor=True)
    ax.grid(which="minor", color=RULE, lw=0.4)
    ax.tick_params(which="minor", length=0)
    ax.set(xlabel="named first (or the verdict)", ylabel="truth")
    ax.set_title("What was there, and what was said (cases)", loc="left", fontsize=11)
    return figure


def reliability(scores: dict[str, Any]) -> Figure:
    """Stated probability against the share that was right, closed and open set apart."""
    parts = scores["summary"]["reliability"]
    panels = (("causes, closed set", "causes, open set"), ("groups, closed set", "groups, open set"),
              ("a gap, all cases", "something unknown, all cases"))  # fmt: skip
    figure, axes = _figure(10.5, 3.8, 3)
    for ax, names in zip(axes, panels, strict=True):
        if any(parts[name]["bins"] for name in names):
            ax.plot([0, 1], [0, 1], color=RULE, lw=1.2, zorder=0)
        for name, colour, marker, shift in zip(names, (RIGHT, IDEAL), "oD", (-0.006, 0.006), strict=True):
            for number, b in enumerate(parts[name]["bins"]):
                x = b["stated"] + shift
                ax.plot([x, x], [b["low"], b["high"]], color=colour, lw=1.6)
                label = f"{name} (n = {parts[name]['n']})" if number == 0 else None
                ax.plot(x, b["k"] / b["n"], marker, color=colour, ms=6, mec=GROUND, label=label)
        ax.set(xlim=(-0.04, 1.04), ylim=(-0.04, 1.04), xlabel="stated probability")
        if any(parts[name]["bins"] for name in names):
            ax.legend(frameon=False, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0))
        else:
            _empty(ax, "nothing stated")
    axes[0].set_ylabel("share that was right")
    return figure


def numbers(scores: dict[str, Any]) -> Figure:
    """Pulls of parameters beside a normal curve, and closure beside the oracle's."""
    figure, (left, right) = _figure(9.5, 3.8, 2)
    pulls = np.array([p for o in scores["outcomes"] for p in o["pulls"]])
    if pulls.size:
        grid = np.linspace(-5, 5, 201)
        left.hist(
            np.clip(pulls, -5, 5),
            np.linspace(-5, 5, 26).tolist(),
            density=True,
            color=GROUPED,
            edgecolor=GROUND,
        )
        left.plot(grid, np.exp(-(grid**2) / 2) / np.sqrt(2 * np.pi), color=IDEAL, lw=1.5)
    else:
        _empty(left, "no parameter of a right cause")
    left.set(xlabel="(stated - true) / stated standard deviation", ylabel="density")
    left.set_title(f"Parameters of right causes (n = {pulls.size})", loc="left", fontsize=11)
    close = [(o["snr"], o["closure"]) for o in scores["outcomes"] if o["closure"] and o["by_group"]]
    for true_snr, (fraction, std, oracle) in close:
        snr = min(true_snr, 200.0)  # the enormous ones stand together at the edge
        right.plot([snr, snr], [fraction - oracle - std, fraction - oracle + std], color=RULE, lw=1)
        right.plot(snr, fraction - oracle, "o", ms=4, color=RIGHT)
    if close:
        right.set_xscale("log")
        right.axhline(0.0, color=IDEAL, lw=1.2)
    else:
        _empty(right, "no closure of a right cause")
    right.set(xlabel="signal-to-noise ratio (200: and up)", ylabel="closure less the oracle's")
    right.set_title(f"How far the gap closed (n = {len(close)})", loc="left", fontsize=11)
    return figure


FIGURES = {
    "causes": causes_against_snr,
    "outside": outside_the_catalogue,
    "confusion": confusion,
    "reliability": reliability,
    "numbers": numbers,
}

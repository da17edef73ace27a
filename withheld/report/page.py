"""A study's page: what was examined, every row as k of n, and the figures."""

import io
import shutil
from pathlib import Path
from typing import Any

from withheld.atomic import write_bytes, write_json, write_text
from withheld.report.figures import FIGURES
from withheld.score.wilson import Share

_CAPTIONS = {
    "causes": "One effect of the catalogue: shares in bands of signal-to-noise ratio, with 95 % intervals, "
    "beside what somebody who knows the waveforms would reach.",
    "outside": "Effects that the diagnoser had no name for.",
    "confusion": "Cases of at most one effect.",
    "reliability": "Stated probabilities against the share that was right, with 95 % intervals.",
    "numbers": "Parameters and closure.",
}


def _head(scores: dict[str, Any]) -> list[str]:
    kinds = scores["summary"]["kinds"]
    words = {
        "nothing": "with nothing wrong", "single": "with one effect", "pair": "with two",
        "triple": "with three",
        "stale": "of stale records", "stale_culprit": "of a stale record and a culprit",
        "strong": "with one strong effect", "link_slow": "with link and slow faults",
        "mixed_quiet": "of mixed runs with nothing wrong", "mixed": "of mixed runs with one effect",
        "slow_log": "of slow logs", "long_run": "of a single run of 100 minutes",
        "near": "with a shape near the catalogue",
        "without": "with an effect taken out of the catalogue", "stranger": "with one that never was in it",
    }  # fmt: skip
    listed = ", ".join(f"{kinds[k]} {text}" for k, text in words.items() if k in kinds)
    if scores["once"]:
        stood = f"It was scored once. Studies of this candidate before it: {scores['studies_before']}."
    else:
        stood = (
            "It tries the path from injection to report and may be run again: it proves nothing about a "
            f"candidate. Studies of this candidate that count, before it: {scores['studies_before']}; "
            f"tries like this: {scores['tries_before']}."
        )
    seals = "".join(f"| {name} | `{digest}` |\n" for name, digest in scores["seals"].items())
    return [
        f"# Withheld study {scores['study']}-{scores['seed']}: {scores['candidate']}\n",
        f"{scores['summary']['cases']} campaigns: {listed}. {stood}\n",
        "Sealed before scoring (SHA-256):\n",
        f"| what | digest |\n|---|---|\n{seals}",
        "Every row is k of n with Wilson's 95 % interval. How the bench works, and what each row means: "
        "`docs/withheld.md`.\n",
    ]


def tables(summary: dict[str, Any]) -> list[str]:
    """Every table with a row that counts anything, in Markdown."""
    parts = []
    for table in summary["tables"]:
        rows = [row for row in table["rows"] if row["n"]]
        if not rows:
            continue
        more = [name for name in ("aim", "clairvoyant") if any(name in row for row in rows)]
        head = "".join(f" {name} |" for name in more)
        lines = f"| | |{head}\n|---|---|{'---|' * len(more)}\n"
        for row in rows:
            beside = "".join(f" {_beside(row[name])} |" if name in row else " |" for name in more)
            lines += f"| {row['row']} | {Share(row['k'], row['n']).text()} |{beside}\n"
        parts.append(f"### {table['title']}\n\n{lines}")
    return parts


def _beside(value: str | float) -> str:
    """An aim in words, or the clairvoyant's share."""
    return value if isinstance(value, str) else f"{100 * value:.1f} %"


def _reliability(summary: dict[str, Any]) -> str:
    lines = ""
    for name, part in summary["reliability"].items():
        if part["n"]:
            lines += f"| {name} | {part['n']} | {part['error']:.3f} | {part['expected_error']:.3f} |\n"
    return (
        "### Reliability\n\nMean distance between stated probability and share right, and what a perfectly "
        "calibrated answer of the same size would show.\n\n"
        f"| | n | distance | if calibrated |\n|---|---|---|---|\n{lines}"
    )


def _spread(summary: dict[str, Any]) -> str:
    names = {
        "pulls": "parameter pulls", "std_over_attainable": "stated over attainable standard deviation",
        "closure_less_oracle": "closure less the oracle's", "group_size": "members in a group",
        "seconds": "seconds a campaign",
    }  # fmt: skip
    lines = ""
    for key, name in names.items():
        q = summary[key]
        if q["n"]:
            lines += f"| {name} | {q['n']} | {q['median']:.3g} | {q['p16']:.3g} to {q['p84']:.3g} |\n"
    return f"### Numbers\n\n| | n | median | 16 to 84 % |\n|---|---|---|---|\n{lines}"


def page(scores: dict[str, Any]) -> str:
    """The page in Markdown; the figures lie beside it."""
    summary = scores["summary"]
    figures = [f"![{text}]({name}.png)\n\n{text}\n" for name, text in _CAPTIONS.items()]
    parts = [*_head(scores), "## Scores\n", *tables(summary), _reliability(summary)]
    return "\n".join([*parts, _spread(summary), "## Figures\n", *figures])


def write_page(scores: dict[str, Any], out: Path) -> None:
    """`out/index.md`, the figures and the scores themselves; a report already there is replaced whole."""
    partial = out.with_name(f".{out.name}.part")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    for name, draw in FIGURES.items():
        picture = io.BytesIO()
        # Without a creation date, so that equal scores give equal bytes.
        draw(scores).savefig(picture, format="png", dpi=110, metadata={"Software": None})
        write_bytes(partial / f"{name}.png", picture.getvalue())
    write_json(partial / "scores.json", scores)
    write_text(partial / "index.md", page(scores))
    shutil.rmtree(out, ignore_errors=True)
    partial.rename(out)

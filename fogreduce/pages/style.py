"""What every page shares, those of a diagnosis too: its style, and what it may load."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

TEMPLATES = Path(__file__).parent / "templates"
#: The library that draws plots that zoom, as it is released.
UPLOT = Path(__file__).parent / "uplot"

#: Pictures that stand in the page, its own style, its own script (by its hash); nothing else.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {}; base-uri 'none'"


#: Tables of more columns than these are blocks on a phone, a block a row.
_MOST_BESIDE = 2
#: A phone names so many columns of a row's block.
_MOST_NAMED = 24
#: What a column's name may hold beside letters and digits: nothing that ends a string of a style sheet.
_PLAIN = " []()/°√²±.,:%-"


def style(*, zooms: bool = False) -> str:
    """The style sheet; with that of plots that zoom."""
    files = [*([UPLOT / "uPlot.min.css"] if zooms else []), TEMPLATES / "style.css"]
    named = "".join(
        f".cards td:nth-child({k})::before{{content:var(--c{k})}}" for k in range(2, _MOST_NAMED + 1)
    )
    sheets = [file.read_text(encoding="utf-8") for file in files]
    return "\n".join([*sheets, f"@media screen and (max-width:640px){{{named}}}\n"])


def cards(heads: Sequence[str], more: str = "") -> Markup:
    """Attributes of a table, by which each of its rows is a block on a phone if it has many columns.

    Parameters
    ----------
    heads : sequence of str
        Of its columns; the first is the block's own title. A phone sets the others before their cells.
    more : str
        Further classes.
    """
    if len(heads) <= _MOST_BESIDE:
        return Markup(f' class="{more}"' if more else "")
    plain = ["".join(c for c in head if c.isalnum() or c in _PLAIN) for head in heads]
    names = ";".join(f"--c{k}:'{name}'" for k, name in enumerate(plain, 1) if k > 1 and name)
    return Markup(' class="{}" style="{}"').format(f"cards {more}".rstrip(), names)


def policy(script: str = "'none'") -> str:
    """The page's Content-Security-Policy; `script` is the hash of its script, as the policy has it."""
    return _POLICY.format(script)

"""What the pages of a diagnosis share: a self-contained document and its tables."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

_STYLE = """body{font:16px/1.5 sans-serif;max-width:960px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0}td,th{border-bottom:1px solid #ddd;padding:.3em .8em;
text-align:left;vertical-align:top}
.quiet{color:#5f5f5f}h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}svg{width:100%;height:auto}
.box{background:#f3f5f8;border-left:4px solid #1d4f80;padding:.6em 1em;margin:1em 0}"""


def document(title: str, parts: Sequence[str]) -> str:
    """A whole page; `parts` are HTML, the title is text."""
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>"
        + "\n".join(parts)
        + "</body></html>\n"
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; head is text, cells are HTML."""
    cells = "".join(f"<th>{escape(h)}</th>" for h in head)
    lines = "".join("<tr>" + "".join(f"<td>{c}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><tr>{cells}</tr>{lines}</table>"

"""What the pages of a diagnosis share: a self-contained document and its tables."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from fogreduce.pages.style import cards, policy, style


def document(title: str, parts: Sequence[str]) -> str:
    """A whole page; `parts` are HTML, the title is text."""
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{escape(policy())}">'
        f'<title>{escape(title)}</title><link rel="icon" href="data:,"><style>{style()}</style></head>'
        "<body><main>" + "\n".join(parts) + "</main></body></html>\n"
    )


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; head is text, cells are HTML."""
    cells = "".join(f'<th scope="col">{escape(h)}</th>' for h in head)
    lines = "".join(
        f'<tr><th scope="row">{first}</th>' + "".join(f"<td>{c}</td>" for c in rest) + "</tr>"
        for first, *rest in rows
    )
    body = f"<thead><tr>{cells}</tr></thead><tbody>{lines}</tbody>"
    return f'<div class="scroll" tabindex="0"><table{cards(head)}>{body}</table></div>'


def both(broad: str, slim: str) -> str:
    """A figure as a screen shows it and as a phone does."""
    return f'<div class="broad">{broad}</div><div class="slim">{slim}</div>'


def items(lines: Sequence[str]) -> str:
    """A list; lines are HTML."""
    return "<ul>" + "".join(f"<li>{line}</li>" for line in lines) + "</ul>"

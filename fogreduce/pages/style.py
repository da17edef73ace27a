"""What every page shares, those of a diagnosis too: its style, and what it may load."""

from __future__ import annotations

from pathlib import Path

TEMPLATES = Path(__file__).parent / "templates"
#: The library that draws plots that zoom, as it is released.
UPLOT = Path(__file__).parent / "uplot"

#: Pictures that stand in the page, its own style, its own script (by its hash); nothing else.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {}; base-uri 'none'"


def style(*, zooms: bool = False) -> str:
    """The style sheet; with that of plots that zoom."""
    files = [*([UPLOT / "uPlot.min.css"] if zooms else []), TEMPLATES / "style.css"]
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def policy(script: str = "'none'") -> str:
    """The page's Content-Security-Policy; `script` is the hash of its script, as the policy has it."""
    return _POLICY.format(script)

"""What every page shares, those of a diagnosis too: its style, and what it may load."""

from __future__ import annotations

from pathlib import Path

TEMPLATES = Path(__file__).parent / "templates"

#: Pictures that stand in the page, its own style, its own script (by its hash); nothing else.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src {}; base-uri 'none'"


def style() -> str:
    """The style sheet."""
    return (TEMPLATES / "style.css").read_text(encoding="utf-8")


def policy(script: str = "'none'") -> str:
    """The page's Content-Security-Policy; `script` is the hash of its script, as the policy has it."""
    return _POLICY.format(script)

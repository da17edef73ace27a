"""The page of effects is what the table says."""

from __future__ import annotations

from pathlib import Path

from effects_page import page

from fogreduce.effects.table import EFFECTS

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_is_in_sync_with_the_table() -> None:
    """If not: python docs/make/effects_page.py docs."""
    assert (DOCS / "effects.md").read_text(encoding="utf-8") == page()


def test_every_effect_has_its_section_once_and_its_plot() -> None:
    text = page()
    for name in EFFECTS:
        assert text.count(f"### `{name}`\n") == 1
        assert (DOCS / "effects" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert len(list((DOCS / "effects").glob("*.png"))) == len(EFFECTS)

"""Templates to whole HTML files: everything inside one file, every value escaped, no script but our own."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from fogreduce.pages import numbers
from fogreduce.pages.style import TEMPLATES, UPLOT, cards, policy, style


@dataclass(frozen=True)
class Crumb:
    """A step on the way to a page: its name, and where it lies relative to the page."""

    name: str
    href: str


def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {
        "number": numbers.number,
        "count": numbers.count,
        "size": numbers.size,
        "duration": numbers.duration,
        "anchor": anchor,
        "cards": cards,
    }
    return environment


def anchor(text: str) -> str:
    """An id for a heading: letters and digits, the rest dashes."""
    return "".join(c if c.isascii() and c.isalnum() else "-" for c in text.lower())


def page(
    template: str,
    title: str,
    context: Mapping[str, Any],
    crumbs: Sequence[Crumb] = (),
    label: str = "",
    scripts: Sequence[str] = (),
) -> str:
    """A whole page.

    Parameters
    ----------
    template : str
        File in the folder ``templates``; it fills the blocks of ``base.html``.
    title : str
    context : mapping
        What the template names. Plain text is escaped; only `Markup` stands as it is.
    crumbs : sequence of Crumb
        The pages above this one, the outermost first.
    label : str
        What the data are, where they are not measured data.
    scripts : sequence of str
        Files of scripts in the folder ``templates``. ``zoom.js`` brings uPlot and its style with it.
    """
    zooms = "zoom.js" in scripts
    files = [*([UPLOT / "uPlot.iife.min.js"] if zooms else []), *(TEMPLATES / name for name in scripts)]
    code = "\n".join(file.read_text(encoding="utf-8") for file in files)
    allowed = f"'sha256-{b64encode(sha256(code.encode()).digest()).decode()}'" if code else "'none'"
    shared = {
        "title": title,
        "crumbs": crumbs,
        "label": label,
        "policy": policy(allowed),
        "style": Markup(style(zooms=zooms)),
        "script": Markup(code),
    }
    return _environment().get_template(template).render({**shared, **context})

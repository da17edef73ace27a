"""The notebook of the docs runs from its first cell to its last, and what each shows can be shown."""

from __future__ import annotations

import ast
import json

import pytest
from matplotlib.figure import Figure


@pytest.mark.slow
def test_notebook(repository, monkeypatch) -> None:
    """Each cell as a notebook runs it: all of it, and the last expression shown."""
    monkeypatch.chdir(repository)
    notebook = json.loads((repository / "docs" / "python.ipynb").read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    names: dict[str, object] = {}
    figures = 0
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"] == [], "outputs are not kept: they grow old"
        tree = ast.parse("".join(cell["source"]), f"cell {number}")
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, f"cell {number}", "exec"), names)
        if last is not None:
            shown = eval(compile(ast.Expression(last.value), f"cell {number}", "eval"), names)
            figures += isinstance(shown, Figure)
            assert repr(shown)
    assert figures == 4
    assert names["found"].verdict == "no_gap"

"""The hash of what modules say, and which modules are used: held against Python's own parser."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import fogreduce
from fogreduce.provenance.code import code_digest, imports, meaning, modules_used

PACKAGE = Path(fogreduce.__file__).parent
SOURCES = sorted(PACKAGE.rglob("*.py"))
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def without_docstrings(source: str) -> str:
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, _DOCUMENTED) and ast.get_docstring(node, clean=False) is not None:
            node.body = node.body[1:]
    return ast.dump(tree)


def imported(source: str, *, only_at_top: bool) -> set[str]:
    """Names that a module imports for use, by the parser."""
    tree = ast.parse(source)
    found: set[str] = set()
    for node in tree.body:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            tree.body.remove(node)
    for node in tree.body if only_at_top else ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports are not followed"
            found.add(node.module or "")
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return {name for name in found if name.split(".")[0] == "fogreduce"}


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_nothing_but_comments_docstrings_and_blank_lines_is_left_out(path: Path) -> None:
    source = path.read_text()
    said = meaning(source)
    assert without_docstrings(said) == without_docstrings(source)
    docstrings = [
        ast.get_docstring(node) for node in ast.walk(ast.parse(said)) if isinstance(node, _DOCUMENTED)
    ]
    assert not any(docstrings)
    top = path == PACKAGE / "__init__.py"
    by_parser = imported(source, only_at_top=top)
    assert by_parser <= imports(said, only_at_top=top)


@pytest.mark.parametrize(
    "edited",
    [
        '"""Another docstring."""\n\n\n# a comment\ndef f(x):  # why\n    """New,\n\n    of lines."""\n'
        '    return "# no comment"\n',
        'def f(x):\n\n    return "# no comment"\n',
    ],
)
def test_words_about_code_do_not_count(edited: str) -> None:
    source = '"""A docstring."""\ndef f(x):\n    """Old."""\n    return "# no comment"\n'
    assert meaning(edited).replace('""\n', "").split() == meaning(source).replace('""\n', "").split()


@pytest.mark.parametrize("edited", ["x = 2\n", "x = 1\ny = 2\n", 'x = """1\n\n2"""\n', 'f(\n"""text"""\n)\n'])
def test_code_counts_and_so_do_blank_lines_of_a_text(edited: str) -> None:
    texts = {meaning(source) for source in ("x = 1\n", 'x = """1\n2"""\n', 'f(\n"""word"""\n)\n', edited)}
    assert len(texts) == 4


def test_a_stage_uses_the_physics_that_it_imports_and_no_other() -> None:
    drift = modules_used("fogreduce.stages.drift")
    assert {"__init__.py", "stages/__init__.py", "estimate/mean_curve.py", "units.py"} <= set(drift)
    assert not {"stages/ingest.py", "datasets/store.py", "datasets/view.py"} & set(drift)


def test_modules_imported_late_or_named_in_a_table_are_used() -> None:
    used = modules_used("fogreduce.datasets.readers")
    assert "datasets/readers/fogcap.py" in used
    assert "plotting/style.py" in modules_used("fogreduce.cli.figures")


def test_a_module_that_is_not_there_is_an_error() -> None:
    with pytest.raises(ValueError, match="no such module"):
        code_digest("fogreduce.stages.nothing")

"""The bench shares nothing with what it examines, and needs little."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted((ROOT / "withheld").rglob("*.py"))
ALLOWED = {"withheld", "numpy", "scipy", "yaml", "matplotlib"} | set(sys.stdlib_module_names)


def imported(source: str) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("(relative)" if node.level else (node.module or "").split(".")[0])
        elif isinstance(node, ast.Name) and node.id == "__import__":
            names.add("(__import__)")
    return names


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_only_what_it_may(path):
    assert imported(path.read_text()) <= ALLOWED


@pytest.mark.parametrize(
    "line", ["import fogreduce.physics", "from fogreduce import x", "from .. import y", "__import__('a')"]
)
def test_the_check_sees_a_forbidden_import(line):
    assert not imported(line) <= ALLOWED


def test_there_is_something_to_check():
    assert len(SOURCES) > 30


def test_no_dynamic_import():
    assert not [path for path in SOURCES if "importlib" in path.read_text()]

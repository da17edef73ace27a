"""Imports point one way, and the way of a reduction imports nothing slow."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

#: What the package's own __init__ offers lazily; anybody may ask for the version.
PACKAGE = "fogreduce"

#: Imports that cost more than the reduction's arithmetic (a third of a second and more each).
SLOW = ("xarray", "scipy", "matplotlib", "pandas")


def modules(root: Path) -> list[Path]:
    return sorted((root / PACKAGE).rglob("*.py"))


def rooms_in_order(root: Path) -> list[str]:
    """The rooms of ARCHITECTURE.md, lowest first: one may import itself and those before it."""
    table = (
        (root / "ARCHITECTURE.md").read_text(encoding="utf-8").partition("| room |")[2].partition("\n\n")[0]
    )
    return re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)


def imported(path: Path, root: Path) -> list[tuple[int, str]]:
    """Every module that a file imports, at its top or within a function: (line, dotted name)."""
    found = []
    here = path.relative_to(root).with_suffix("").parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(here[: -node.level]) if node.level else ""
            module = ".".join(filter(None, (base, node.module)))
            # `from fogreduce import physics` names a module in its list of names.
            found += [(node.lineno, f"{module}.{alias.name}") for alias in node.names]
        elif isinstance(node, ast.Call) and ast.unparse(node.func) in (
            "importlib.import_module",
            "__import__",
        ):
            for text in ast.walk(node):
                if isinstance(text, ast.Constant) and isinstance(text.value, str):
                    found.append((node.lineno, text.value))
    return found


def circle(root: Path) -> list[str]:
    """Modules that import each other in a circle, inside rooms too; empty where there is none.

    The package's own __init__, which offers names lazily, is left out.
    """
    names = {
        ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path
        for path in modules(root)
    }
    imports: dict[str, set[str]] = {}
    for module, path in names.items():
        imports[module] = set()
        for _, name in imported(path, root):
            while name and name not in names:  # a name in a module, not a module
                name = name.rpartition(".")[0]
            if name not in ("", PACKAGE, module):
                imports[module].add(name)
    try:
        list(TopologicalSorter(imports).static_order())
    except CycleError as error:
        return [str(module) for module in error.args[1]]
    return []


def test_no_module_imports_itself_by_way_of_others(repository, tmp_path) -> None:
    assert circle(repository) == []
    (tmp_path / PACKAGE / "physics").mkdir(parents=True)
    (tmp_path / PACKAGE / "physics" / "one.py").write_text("from fogreduce.physics.two import that\n")
    late = "def that():\n    from fogreduce.physics import one\n"
    (tmp_path / PACKAGE / "physics" / "two.py").write_text(late)
    assert set(circle(tmp_path)) == {"fogreduce.physics.one", "fogreduce.physics.two"}


def test_every_room_has_its_place(repository) -> None:
    rooms = {
        path.relative_to(repository / PACKAGE).parts[0].removesuffix(".py") for path in modules(repository)
    }
    assert sorted(rooms_in_order(repository)) == sorted(rooms - {"__init__", "__main__"})


def test_imports_point_down(repository) -> None:
    order = {room: place for place, room in enumerate(rooms_in_order(repository))}
    wrong = []
    for path in modules(repository):
        part = path.relative_to(repository / PACKAGE).parts[0].removesuffix(".py")
        if part in ("__init__", "__main__"):
            continue
        for line, name in imported(path, repository):
            pieces = name.split(".")
            if pieces[0] != PACKAGE or len(pieces) == 1 or pieces[1] in ("__version__", "__file__"):
                continue
            if order[pieces[1]] > order[part]:
                wrong.append(f"{path.relative_to(repository)}:{line}: {part} imports {name}")
    assert wrong == []


def test_every_import_within_a_function_is_listed_with_the_time_that_it_saves(repository) -> None:
    """If not: python docs/make/late_imports.py docs/start-up.md."""
    sys.path.insert(0, str(repository / "docs" / "make"))
    from late_imports import late_imports

    rows = re.findall(r"^\| `(.+)` \| (.+) \| (\d+) \|$", (repository / "docs/start-up.md").read_text(), re.M)
    listed = {file: names.split() for file, names, saved_ms in rows if int(saved_ms) > 1}
    found = {str(path.relative_to(repository)): late_imports(path) for path in modules(repository)}
    assert listed == {
        file: [name.removeprefix("fogreduce.") for name in names] for file, names in found.items() if names
    }


def test_the_package_needs_neither_tests_nor_the_bench(repository) -> None:
    wrong = [
        f"{path.relative_to(repository)}:{line}: {name}"
        for path in modules(repository)
        for line, name in imported(path, repository)
        if name.split(".")[0] in ("withheld", "tests", "pytest", "hypothesis", "allantools", "netCDF4")
    ]
    assert wrong == []


def test_the_search_for_imports_sees_every_kind(tmp_path) -> None:
    """The parser above, on a file that imports in every way."""
    source = tmp_path / PACKAGE / "physics" / "odd.py"
    source.parent.mkdir(parents=True)
    lines = [
        "import fogreduce.cli.main",
        "from fogreduce import stages",
        "from ..cli import check",
        "def late():",
        "    from withheld.chain import noise",
        "    importlib.import_module('fogreduce.plotting.style')",
    ]
    source.write_text("\n".join(lines))
    assert [name for _, name in imported(source, tmp_path)] == [
        "fogreduce.cli.main",
        "fogreduce.stages",
        "fogreduce.cli.check",
        "withheld.chain.noise",
        "fogreduce.plotting.style",
    ]


def loaded_after(code: str) -> list[str]:
    """Which slow modules are loaded after some code, in a fresh interpreter."""
    script = f"{code}\nimport sys\nprint([name for name in {SLOW!r} if name in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return ast.literal_eval(answer.stdout.strip().splitlines()[-1])


@pytest.mark.parametrize(
    "code", ["import fogreduce", "import fogreduce.cli.main", "import fogreduce.stages.run"]
)
def test_imports_are_light(code: str) -> None:
    assert loaded_after(code) == []


def test_a_reduction_imports_nothing_slow(bench) -> None:
    """The whole command on a small run; and the view, to see that the test can tell."""
    run = bench.run(profile=[(3.0, 10.0)])
    out = bench.root / "out"
    words = ["reduce", str(run), "--calibrations", str(bench.calibrations), "--out", str(out)]
    reduce = f"from fogreduce.cli.main import main\nassert main({words!r}) == 0"
    assert loaded_after(reduce) == []
    assert (out / "tables" / "drift.csv").is_file()
    assert "xarray" in loaded_after("from fogreduce import open_run")

"""The worked examples of docs/your-files.md, executed: from a logger's file to the page."""

import importlib.util
import re
import shlex
import sys
from pathlib import Path

import pytest

from fogreduce.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
_SPEC = importlib.util.spec_from_file_location(
    "laboratory_files", ROOT / "tests" / "datasets" / "laboratory_files.py"
)
laboratory_files = importlib.util.module_from_spec(_SPEC)
sys.modules["laboratory_files"] = laboratory_files  # dataclasses look their module up
_SPEC.loader.exec_module(laboratory_files)

#: Section of the page -> who writes its logger's file.
EXAMPLES = {
    "1": laboratory_files.german,
    "2": laboratory_files.tdms,
    "3": laboratory_files.packed_without_header,
}


def section(number):
    page = (ROOT / "docs" / "your-files.md").read_text()
    return re.search(rf"^## {number}\. .*?(?=^## |\Z)", page, re.M | re.S)[0]


def fill_in(folder, block):
    """Replace the lines that ask by those of the page."""
    (path,) = folder.glob("runs/*/run.yaml")
    head, rest = path.read_text().split("\n# What follows", 1)
    assert "TODO" in head
    comments = [line for line in head.splitlines() if line.startswith("#")]
    path.write_text("\n".join([*comments, block, "# What follows" + rest]))


@pytest.mark.parametrize("number", EXAMPLES)
def test_from_file_to_page(number, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    EXAMPLES[number](tmp_path, laboratory_files.recording())
    text = section(number)
    filled = re.findall(r"```yaml\n(.*?)```", text, re.S)
    for block in re.findall(r"```sh\n(.*?)```", text, re.S):
        for line in block.splitlines():
            words = shlex.split(line)
            assert words[0] == "fogreduce"
            assert main(words[1:]) == 0
            if words[1] == "init" and filled:
                fill_in(tmp_path / "bench", filled[0])
    assert "Rates" in (tmp_path / "out" / "index.html").read_text()
    assert "TODO" not in (tmp_path / "out" / "index.html").read_text()

"""A reader that a laboratory installs as a package of its own: found by entry point, part of the version."""

import importlib
import json
import sys

import pytest
from small_lab import RECORDS, csv_lines

from fogreduce.cli.main import main

FORMAT = "logger-1"
#: The laboratory's logger writes csv-1 with a line of its own before it.
SOURCE = """\
import tempfile
from pathlib import Path

from fogreduce.datasets.readers.csv1 import CsvReader


class LoggerReader(CsvReader):
    def __init__(self, path, *settings):
        self.copy = tempfile.TemporaryDirectory()
        plain = Path(self.copy.name) / path.name
        plain.write_text(path.read_text().partition("\\n")[2])
        super().__init__(plain, *settings)
"""


class Package:
    """A package as an installer leaves it: its code and what describes it."""

    def __init__(self, site, name="lab-logger", module="lab_logger"):
        self.site, self.name, self.module = site, name, module
        self.code = site / module / "reader.py"
        self.code.parent.mkdir(parents=True)
        (site / module / "__init__.py").write_text("")
        self.write(SOURCE)
        self.describe("1.0")

    def write(self, source):
        self.code.write_text(source)
        importlib.invalidate_caches()

    def describe(self, version, name_of_class="LoggerReader"):
        about = self.site / f"{self.module}-1.0.dist-info"
        about.mkdir(exist_ok=True)
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {self.name}\nVersion: {version}\n")
        (about / "entry_points.txt").write_text(
            f"[fogreduce.readers]\n{FORMAT} = {self.module}.reader:{name_of_class}\n"
        )
        importlib.invalidate_caches()


@pytest.fixture
def package(tmp_path, monkeypatch):
    site = tmp_path / "site"
    monkeypatch.syspath_prepend(str(site))
    yield Package(site)
    for name in [name for name in sys.modules if name.startswith("lab_logger")]:
        del sys.modules[name]


@pytest.fixture
def logged(small_lab):
    """The small laboratory's run as its logger writes it."""
    small_lab.capture.unlink()
    path = small_lab.run / "log.txt"
    path.write_text("Logger 3, channel A\n" + "\n".join(csv_lines()) + "\n")
    small_lab.write_run({"capture.file": path.name, "capture.format": FORMAT})
    return small_lab


def manifest(lab):
    arguments = ["manifest", str(lab.run), "--calibrations", str(lab.calibrations), "--out", str(lab.out)]
    assert main(arguments) == 0
    return json.loads((lab.out / "manifest.json").read_text())


def test_it_is_found_and_recorded(package, logged):
    assert main(["check", str(logged.run), "--calibrations", str(logged.calibrations)]) == 0
    assert main(logged.reduce()) == 0
    assert f"records,{RECORDS}," in (logged.out / "tables" / "quality.csv").read_text()
    software = json.loads((logged.out / "manifest.json").read_text())["software"]
    assert software["reader"] == "lab-logger 1.0"
    assert len(software["reader_code_sha256"]) == 64


def test_its_code_and_version_count_in_the_version_id(package, logged):
    before = manifest(logged)
    assert manifest(logged) == before
    package.write(SOURCE + "\n\nSHIFT = 1\n")
    edited = manifest(logged)
    package.describe("1.1")
    renamed = manifest(logged)
    ids = [document["version_id"] for document in (before, edited, renamed)]
    assert len(set(ids)) == 3
    codes = [document["software"]["reader_code_sha256"] for document in (before, edited, renamed)]
    assert codes[0] != codes[1] == codes[2]


def test_a_package_beside_it_does_not_count(package, small_lab):
    """A run in a format of this package's own is the same whatever a laboratory has installed."""
    before = manifest(small_lab)
    package.describe("1.1")
    assert manifest(small_lab) == before
    assert "reader" not in before["software"]


def test_an_unknown_format_is_told_what_is_installed(package, logged, capsys):
    logged.write_run({"capture.file": "log.txt", "capture.format": "logger-2"})
    assert main(logged.reduce()) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{logged.yaml}: capture.format: found logger-2; expected one of fogcap-1, csv-1")
    assert error.endswith(f"{FORMAT}\n")
    assert error.count("\n") == 1


def test_a_reader_that_does_not_import_is_one_line(package, logged, capsys):
    package.describe("1.0", name_of_class="NoSuchReader")
    assert main(logged.reduce()) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"package lab-logger: entry point {FORMAT}: found AttributeError: ")
    assert error.count("\n") == 1


def test_two_packages_for_one_format_are_refused(package, logged, capsys):
    Package(package.site, "other-logger", "lab_logger_other")
    assert main(logged.reduce()) == 2
    expected = f"entry points fogreduce.readers: {FORMAT}: found lab-logger and other-logger; "
    assert capsys.readouterr().err == expected + "expected one package with a reader of that format\n"

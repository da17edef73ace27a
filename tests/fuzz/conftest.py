"""Makes this folder's modules and the small laboratory importable; gives a laboratory to be spoilt."""

import sys
from pathlib import Path

import pytest

for folder in (Path(__file__).parent, Path(__file__).parents[1] / "cli"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

from fuzz_lab import FuzzLab  # noqa: E402


@pytest.fixture(scope="session")
def fuzz_lab(tmp_path_factory):
    """A laboratory whose capture is of fogcap-1; every test leaves it as it was."""
    return FuzzLab(tmp_path_factory.mktemp("fuzz").resolve())


@pytest.fixture(scope="session")
def csv_lab(tmp_path_factory):
    """A laboratory whose capture is of csv-1."""
    lab = FuzzLab(tmp_path_factory.mktemp("fuzz-csv").resolve())
    lab.use_csv()
    return lab

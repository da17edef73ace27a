"""Makes the builders of tests/archive importable, whatever the import mode; gives an archived campaign."""

import sys
from pathlib import Path

import pytest

_BUILDERS = str(Path(__file__).parent)
if _BUILDERS not in sys.path:
    sys.path.insert(0, _BUILDERS)

from archived_lab import ArchivedLab  # noqa: E402


@pytest.fixture(scope="session")
def archived(tmp_path_factory):
    """Two runs simulated, reduced, summed up and archived; not to be changed by a test."""
    return ArchivedLab(tmp_path_factory.mktemp("archived"))


@pytest.fixture
def bag(archived, tmp_path):
    """A copy of the bag, to be spoilt."""
    return archived.copy(tmp_path / "bag")


@pytest.fixture(scope="session")
def repository_root():
    """The repository."""
    return Path(__file__).resolve().parents[2]

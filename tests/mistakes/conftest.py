"""Makes the good run of tests/mistakes importable, whatever the import mode; simulates it once."""

import sys
from pathlib import Path

import pytest

_HERE = str(Path(__file__).parent)
if _HERE not in sys.path:
    sys.path.insert(0, _HERE)

from good_run import DIGITAL, DIGITAL_RECORD, GOOD, RECORD_FILE, GoodRun  # noqa: E402

from fogreduce.metadata.yaml12 import load_yaml  # noqa: E402


@pytest.fixture(scope="session")
def good(tmp_path_factory):
    """The good run of the published unit; not to be changed."""
    return GoodRun(tmp_path_factory.mktemp("mistakes"), GOOD, load_yaml(RECORD_FILE), 5)


@pytest.fixture(scope="session")
def digital(tmp_path_factory):
    """The good run of a digital unit; not to be changed."""
    return GoodRun(tmp_path_factory.mktemp("digital"), DIGITAL, DIGITAL_RECORD, 6)

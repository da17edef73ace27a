"""Makes the helpers of tests/pages importable, whatever the import mode; gives a reduced laboratory."""

import sys
from pathlib import Path

import pytest

_HELPERS = str(Path(__file__).parent)
if _HELPERS not in sys.path:
    sys.path.insert(0, _HELPERS)

from pages_lab import Lab  # noqa: E402


@pytest.fixture(scope="session")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Lab:
    return Lab(tmp_path_factory.mktemp("pages"))

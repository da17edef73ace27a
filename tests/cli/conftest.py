"""Makes the builders of tests/cli importable, whatever the import mode, and gives a small laboratory."""

import sys
from pathlib import Path

import pytest

for _BUILDERS in (
    str(Path(__file__).parent),
    *(str(Path(__file__).parents[1] / name) for name in ("diagnosis", "datasets")),
):
    if _BUILDERS not in sys.path:
        sys.path.insert(0, _BUILDERS)

from small_lab import SmallLab  # noqa: E402


@pytest.fixture
def small_lab(tmp_path):
    """A campaign of one run, its calibration record, and a folder for results that does not exist yet."""
    return SmallLab(tmp_path)

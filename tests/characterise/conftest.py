"""The bench of the derivation's tests, shared: short runs about three axes, simulated."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import pytest

_PATH = Path(__file__).parents[1] / "calibrate" / "conftest.py"
_SPEC = importlib.util.spec_from_file_location("derivation_bench", _PATH)
assert _SPEC is not None
assert _SPEC.loader is not None
derivation_bench = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(derivation_bench)


@pytest.fixture
def bench(tmp_path: Path) -> Any:
    """Folders of calibration records and campaigns; `simulate` makes a campaign with captures."""
    return derivation_bench.Bench(tmp_path)


@pytest.fixture(scope="session")
def noise() -> Any:
    """`noise.py` beside this file: series whose Allan variance is known."""
    spec = importlib.util.spec_from_file_location("characterise_noise", Path(__file__).with_name("noise.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module

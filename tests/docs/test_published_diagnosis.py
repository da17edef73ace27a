"""The published run's account: in sync with its page, and with what the paper prints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from published_diagnosis import (
    FIELD,
    FIGURE,
    OFFSET,
    PAGE,
    RAMP,
    SCALE,
    TIP,
    Account,
    changed,
    figure,
    text,
    together,
)

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def account() -> Account:
    return Account.of(ROOT / "campaigns" / "published", ROOT / "calibrations")


def test_page_and_figure_are_in_sync(account) -> None:
    """But for the last section: what a diagnosis says of the reconstruction, noise and all."""
    page, last = (ROOT / "docs" / PAGE).read_text(), "## The blind diagnosis"
    assert page.split(last)[0] == text(account, "").split(last)[0]
    assert page.count(last) == 1
    assert len(page.split(last)[1]) > 500
    assert (ROOT / "docs" / FIGURE).read_text() == figure(account)


def test_drifts_and_offsets_are_the_papers(account) -> None:
    parts = account.parts(account.residual)
    # Table 5 integrated, as shared/paper/README.md has it
    assert parts[:, 1] + parts[:, 2] == pytest.approx([2.768, 1.492, -0.578], abs=0.006)
    # Table 5's a [deg/s], the commanded rate taken off; a is at t = 0 without the wave
    printed = np.array([0.062105507 - 0.06, -0.003361269, 0.004168715]) * 3600.0
    assert parts[:, 0] + parts[:, 1] == pytest.approx(printed, abs=0.02)


def test_explanations_that_the_run_cannot_tell_apart_fit_it_alike(account) -> None:
    for keys in ([OFFSET, RAMP, FIELD], [SCALE, RAMP, FIELD], [OFFSET, RAMP, TIP]):
        change = sum(changed(account, account.one, together(account, keys)).values(), np.zeros(1))
        # a scale factor of ten per cent, taken for small, misses a bias by its square: nothing that shows
        assert float(np.max(np.abs(account.residual - change))) < 0.05, keys

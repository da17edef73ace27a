"""Numbers on pages."""

from __future__ import annotations

import pytest

from fogreduce.pages.numbers import apart


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([0.0, 0.1, 0.2], ["0", "0.1", "0.2"]),
        ([9.12296, 9.12304, 9.12312], ["9.12296", "9.12304", "9.12312"]),
        ([-20.0791, -20.079], ["\u221220.0791", "\u221220.079"]),
        ([5.0, 5.0], ["5", "5"]),
        ([], []),
    ],
)
def test_ticks_are_told_apart(values, texts):
    assert apart(values) == texts

"""Which rows a fault names of a table with more of them than a line takes."""

from __future__ import annotations

from pathlib import Path

import pytest

from fogreduce.errors import BadInput
from fogreduce.provenance.cell import CellName, find_cell


def test_rows_over_all_segments_are_named(tmp_path: Path) -> None:
    rows = [f"{axis},{segment},1.0" for segment in (*range(1, 7), "all") for axis in "xyz"]
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables" / "drift.csv").write_text("\n".join(["axis,segment,drift_deg_h", *rows, ""]))
    with pytest.raises(BadInput) as told:
        find_cell(tmp_path, CellName.parse("drift.csv:x:drift_deg_h"))
    assert "found 7 rows x; expected one row of x@all, y@all, z@all, x@1, y@1" in str(told.value)
    assert str(told.value).endswith(" and 9 more")
    assert find_cell(tmp_path, CellName.parse("drift.csv:x@all:drift_deg_h")).line == 20

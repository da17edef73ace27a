"""Allan deviation of a reduced run, from its folder and as a Dataset, and the command's tables."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest

import fogreduce
from fogreduce.characterise.allan_run import allan_of_run
from fogreduce.cli.main import main
from fogreduce.errors import BadInput


def rows(path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_published_run(published) -> None:
    """The paper's Table 4 implies 33.4, 25.3, 29.6 and 30.6 microvolts of white noise a sample."""
    with fogreduce.open_run(published.reduced.out) as view:
        found = fogreduce.allan(view, kinds=("overlapping",), factors=(1, 2, 4))
    scale = np.abs(published.reduced.setup.facts.scale_factor)
    for k, sigma_v in enumerate((33.4e-6, 25.3e-6, 29.6e-6, 30.6e-6)):
        expected = sigma_v / scale[k] * 60 / math.sqrt(128)
        assert found[f"gyro{k + 1}"].coefficient("N").value == pytest.approx(expected, rel=0.005)
    assert [one.name for one in found.channels][-3:] == ["x", "y", "z"]
    assert found["x"].missing == 324


def test_command_and_dataset_agree(bench, tmp_path) -> None:
    """Of two rates the longer segment; tables of the run's version; a Dataset of it gives the same."""
    run = bench.run(profile=[(0.0, 5.0), (3.0, 40.0)])
    reduced, out = bench.root / "out", tmp_path / "allan"
    assert main(["reduce", str(run), "--calibrations", str(bench.calibrations), "--out", str(reduced)]) == 0
    assert main(["allan", str(reduced), "--out", str(out)]) == 0
    names = ["allan.csv", "allan.png", "allan.svg", "noise.csv", "spectrum.csv"]
    assert sorted(path.name for path in out.iterdir()) == names
    with fogreduce.open_run(reduced) as view:
        found = fogreduce.allan(view)
        version_id = view.attrs["version_id"]
    for name in ("allan", "noise", "spectrum"):
        table = rows(out / f"{name}.csv")
        assert {(row["segment"], row["version_id"]) for row in table} == {("2", version_id)}
    table = [row for row in rows(out / "allan.csv") if (row["channel"], row["kind"]) == ("x", "total")]
    np.testing.assert_allclose(
        [float(row["high_95_deg_h"] or "nan") for row in table],
        found["x"].deviations["total"].high_95,
        rtol=1e-12,
    )
    before = {name: (out / name).read_bytes() for name in names}
    assert main(["allan", str(reduced), "--out", str(out)]) == 0
    assert {name: (out / name).read_bytes() for name in names} == before


def test_what_is_not_a_run_is_refused(tmp_path) -> None:
    with pytest.raises(BadInput, match=r"manifest\.json"):
        allan_of_run(tmp_path)
    import xarray as xr

    with pytest.raises(BadInput, match="open_run"):
        fogreduce.allan(xr.Dataset())
    assert main(["allan", str(tmp_path / "none")]) == 2

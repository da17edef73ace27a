"""The functions of `fogreduce` in Python, as somebody uses them who has read their help."""

from __future__ import annotations

import importlib
import pydoc
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure

import fogreduce
from fogreduce.errors import BadInput

FUNCTIONS = ("allan", "diagnose", "open_campaign", "open_run", "reduce", "simulate")


def test_dir_and_help_list_them() -> None:
    assert set(FUNCTIONS) <= set(dir(fogreduce))
    text = pydoc.render_doc(fogreduce, renderer=pydoc.plaintext)
    for name in FUNCTIONS:
        function = getattr(fogreduce, name)
        assert "Parameters" in function.__doc__
        assert "Returns" in function.__doc__
        assert f"    {name}(" in text
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = fogreduce.nothing


def test_a_subpackage_does_not_hide_a_function() -> None:
    """``fogreduce.simulate`` is the function's package too, which imports itself at the first call."""
    importlib.import_module("fogreduce.simulate.plan")
    assert callable(fogreduce.simulate)


def test_none_is_imported_before_it_is_asked_for() -> None:
    code = (
        "import fogreduce, sys; dir(fogreduce); print([n for n in sys.modules if n.startswith('fogreduce.')])"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert answer.stdout.strip() == "[]"


def test_reduce_is_the_command(bench, tmp_path) -> None:
    run = bench.run(profile=[(3.0, 10.0)])
    found = fogreduce.reduce(run, bench.calibrations, tmp_path / "out")
    assert repr(found).startswith(f"Reduction of {run.name}: ")
    assert "drift [deg/h] x" in repr(found)
    assert found.table("drift")["axis"].tolist() == ["x", "y", "z"]
    assert isinstance(found.plot("rates"), Figure)
    with found.open() as view:
        assert view.sizes["axis"] == 3
    with pytest.raises(ValueError, match="expected one of quality"):
        found.table("nothing")
    with pytest.raises(ValueError, match="no figure nothing; expected one of"):
        found.plot("nothing")
    with pytest.raises(BadInput, match="a run's folder"):
        fogreduce.reduce(tmp_path / "none", bench.calibrations, tmp_path / "out")


def test_simulated_readings_are_those_reduced(published, repository, tmp_path) -> None:
    """The campaign's first readings are those of the view of its reduction."""
    campaign, calibrations = repository / "campaigns" / "published", repository / "calibrations"
    found = fogreduce.simulate(campaign, calibrations, tmp_path / "c")
    assert repr(found) == "Simulation of published: 1 captures (x-one-turn)"
    with fogreduce.open_run(published.reduced.out) as view:
        there = view["volts"].isel(time=slice(0, 100)).values
    np.testing.assert_array_equal(found.open().isel(time=slice(0, 100)).values, there)
    assert len(found.plot().axes) == 4
    with pytest.raises(ValueError, match="expected one of x-one-turn"):
        found.open("nothing")


def test_runs_of_a_campaign_along_a_dimension(bench, tmp_path) -> None:
    """Two runs of different lengths: what the longer has alone is filled."""
    for name, length in (("long", 20.0), ("short", 10.0)):
        run = bench.run(profile=[(3.0, length)])
        fogreduce.reduce(run, bench.calibrations, tmp_path / "results" / name)
    data = fogreduce.open_campaign(tmp_path / "results")
    assert data["run"].values.tolist() == ["long", "short"]
    long, short = data["records"].values.tolist()
    assert long == 2 * short
    for name, records in (("long", long), ("short", short)):
        with fogreduce.open_run(tmp_path / "results" / name) as view:
            for variable in ("gyro_rate", "axis_rate", "flag"):
                found = data[variable].sel(run=name)
                np.testing.assert_array_equal(found[..., :records].values, view[variable].values)
            np.testing.assert_array_equal(data["time"].sel(run=name)[:records].values, view["time"].values)
    beyond = data.sel(run="short").isel(record=slice(short, None))
    assert np.isnan(beyond["gyro_rate"].values).all()
    assert np.isnat(beyond["time"].values).all()
    # One number, and a step through records, as numpy has it.
    whole = data["gyro_rate"].values
    assert data["gyro_rate"][0, 1, 7].values == whole[0, 1, 7]
    np.testing.assert_array_equal(data["gyro_rate"][1, ::2, 3:-3:5].values, whole[1, ::2, 3:-3:5])
    np.testing.assert_array_equal(
        data["gyro_rate"][:, [2, 0]][..., [9, 4]].values, whole[:, [2, 0]][..., [9, 4]]
    )


def test_what_is_no_campaign_is_refused(tmp_path) -> None:
    with pytest.raises(BadInput, match="no such folder"):
        fogreduce.open_campaign(tmp_path / "none")
    with pytest.raises(BadInput, match="no reduced run"):
        fogreduce.open_campaign(tmp_path)

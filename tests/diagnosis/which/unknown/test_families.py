"""Families of the unknown hold what they are meant to: columns of effects that they stand for lie in them."""

from __future__ import annotations

import numpy as np
import pytest
from bench_lab import lab
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.noise_model import Whitener, whitener
from fogreduce.diagnosis.observe.capture import RunInput, read_inputs
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.diagnosis.which.catalogue.candidates import all_candidates
from fogreduce.diagnosis.which.unknown.families import families

Array = NDArray[np.float64]
NAMES = frozenset({"latitude_error", "mount_rotation", "heading_error", "bias_step", "table_rate_error"})


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[RunInput], Whitener, Builder]:
    """Six runs without captures, their filters, and what builds candidates."""
    root = tmp_path_factory.mktemp("lab")
    lab(root)
    for run in (root / "plan" / "runs").iterdir():
        (run / "capture.fogcap").touch()
    (root / "plan" / "campaign.yaml").write_text("schema: fogreduce/campaign/1\nname: plan\n")
    inputs = read_inputs(root / "plan", root / "cal")
    sizes = [np.full((4, one.scene.blocks.count), 64.0) for one in inputs]
    whiten = whitener(inputs, sizes, np.ones(4))
    return inputs, whiten, Builder(inputs, whiten, [], NAMES, {})


def _left(column: Array, family: Candidate) -> float:
    """Least share of a column's length that a point of a family leaves."""
    lengths = []
    for j in range(family.columns.shape[1]):
        span = family.columns[:, j, :]
        fitted = span @ np.linalg.lstsq(span, column, rcond=None)[0]
        lengths.append(float(np.linalg.norm(column - fitted) / np.linalg.norm(column)))
    return min(lengths)


@pytest.mark.parametrize("effect", ["latitude_error", "heading_error"])
def test_a_site_that_is_off_is_a_rotation_fixed_in_the_room(
    problem: tuple[list[RunInput], Whitener, Builder], effect: str
) -> None:
    inputs, whiten, builder = problem
    known = next(one for one in all_candidates(builder) if one.effect == effect)
    found = [f for f in families(inputs, whiten, builder.plain, NAMES) if f.channels == ("table",)]
    assert min(_left(known.columns[:, 0, 0], f) for f in found) < 1e-3


def test_a_unit_set_askew_is_an_axis_tipped_in_every_run(
    problem: tuple[list[RunInput], Whitener, Builder],
) -> None:
    inputs, whiten, builder = problem
    known = next(one for one in all_candidates(builder) if one.effect == "mount_rotation")
    found = [f for f in families(inputs, whiten, builder.plain, NAMES) if f.channels == ("table",)]
    for k in range(3):
        assert min(_left(known.columns[:, 0, k], f) for f in found) < 0.01


def test_a_step_is_among_the_families_of_its_run(
    problem: tuple[list[RunInput], Whitener, Builder],
) -> None:
    inputs, whiten, builder = problem
    known = next(one for one in all_candidates(builder) if one.effect == "bias_step")
    found = families(inputs, whiten, builder.plain, NAMES)
    same = [f for f in found if (f.channels, f.runs, f.feature) == (known.channels, known.runs, "step")]
    assert len(same) == 1
    np.testing.assert_array_equal(same[0].columns, known.columns)
    with_it, without = same[0].share, None
    for f in families(inputs, whiten, builder.plain, NAMES - {"bias_step"}):
        if (f.channels, f.runs, f.feature) == (known.channels, known.runs, "step"):
            without = f.share
    assert without is not None
    assert with_it < without

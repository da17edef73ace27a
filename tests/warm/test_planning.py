"""The check that planning is relieved of is the one we know, and is done where it could find something."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
import snakemake.api  # before snakemake.dag, which it imports
from snakemake.dag import DAG
from snakemake.exceptions import ChildIOException

from fogreduce.warm.planning import any_inside, hasten

assert snakemake.api


class Other:
    """A DAG whose check is not the one we know."""

    def check_directory_outputs(self) -> None: ...


@pytest.fixture(autouse=True)
def thresholds() -> Iterator[None]:
    before = gc.get_threshold()
    yield
    gc.set_threshold(*before)


@pytest.fixture
def dag() -> type[Any]:
    """Snakemake's DAG, for this test alone."""
    return type("DAG", (DAG,), {"check_directory_outputs": DAG.check_directory_outputs})


class Job:
    def __init__(self, output: list[str]) -> None:
        self.output = output


def jobs(*outputs: list[str]) -> SimpleNamespace:
    return SimpleNamespace(jobs=[Job(files) for files in outputs])


def test_the_check_of_this_snakemake_is_the_known_one(dag: type[Any]) -> None:
    hasten(dag)
    assert dag.check_directory_outputs is not DAG.check_directory_outputs
    assert gc.get_threshold()[0] == 100_000


def test_another_check_is_left_alone() -> None:
    before = Other.check_directory_outputs
    hasten(Other)
    assert Other.check_directory_outputs is before
    hasten(object)  # nor is one missed that is not there


def test_an_output_inside_another_jobs_output_is_refused_as_before(dag: type[Any]) -> None:
    hasten(dag)
    dag.check_directory_outputs(jobs(["r/a/figures"], ["r/a/figures.csv", "r/b/x"]))
    with pytest.raises(ChildIOException):
        dag.check_directory_outputs(jobs(["r/a/figures"], ["r/a/figures/deep/one.png"]))


@pytest.mark.parametrize(
    ("files", "inside"),
    [
        ([], False),
        (["a", "b/c", "b/d"], False),
        (["a", "a-b", "a.b/c"], False),
        (["a/b/c", "a"], True),
        (["a/b", "./a"], True),
        (["/a/b/c", "/a/b"], True),
    ],
)
def test_any_inside(files: list[str], inside: bool) -> None:
    assert any_inside(files) is inside

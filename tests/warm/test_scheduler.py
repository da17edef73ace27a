"""The costs that the scheduler is relieved of are there, as we think they are; nothing else is touched."""

from __future__ import annotations

import inspect

from snakemake.scheduling.greedy import Scheduler as Greedy
from snakemake.scheduling.job_scheduler import JobScheduler

from fogreduce.warm.scheduler import lighten


class Solver:
    def select_jobs(self) -> None: ...


class Other:
    def select_jobs(self) -> None: ...


class Scheduler:
    """As Snakemake's, as far as it is touched."""

    def __init__(self, chosen: object) -> None:
        self.job_rate_limiter: object | None = object()
        self.job_selector_greedy = Solver().select_jobs
        self._job_selector = chosen.select_jobs  # type: ignore[attr-defined]

    @property
    def remaining_jobs(self) -> list[int]:
        return [1, 2, 3]


def test_the_greedy_solver_is_not_given_what_it_does_not_look_at() -> None:
    light, other = Scheduler(Solver()), Scheduler(Other())
    lighten(light)
    lighten(other)
    assert (light.job_rate_limiter, other.job_rate_limiter) == (None, None)
    assert list(light.remaining_jobs) == []
    assert other.remaining_jobs == [1, 2, 3]
    assert Scheduler(Solver()).remaining_jobs == [1, 2, 3]


def test_a_scheduler_built_otherwise_is_left_alone() -> None:
    lighten(object())


def test_snakemake_is_built_so() -> None:
    assert isinstance(inspect.getattr_static(JobScheduler, "remaining_jobs"), property)
    source = inspect.getsource(JobScheduler)
    for name in ("self.job_rate_limiter = ", "self._job_selector = ", "self.job_selector_greedy = "):
        assert name in source
    assert "remaining_jobs" not in inspect.getsource(Greedy.select_jobs).split('"""', 2)[2]

"""Two costs of Snakemake 9's scheduler that grow with the number of jobs, taken away where none needs them.

A limit of 100 jobs a second, meant for clusters, holds on one machine too: each round of the scheduler sets a
timer for another round a second later, which sets its own, so that after a thousand jobs there are a thousand
rounds a second.  And each round lists all jobs that remain, for a solver that plans ahead; the greedy one
does not look.
"""

from __future__ import annotations

from typing import Any


def lighten(scheduler: Any) -> None:
    """Take both away from a scheduler on one machine; one that is built otherwise is left alone."""
    if getattr(scheduler, "job_rate_limiter", None) is not None:
        scheduler.job_rate_limiter = None
    kind = type(scheduler)
    chosen = getattr(getattr(scheduler, "_job_selector", None), "__func__", None)
    greedy = getattr(getattr(scheduler, "job_selector_greedy", None), "__func__", None)
    if (
        chosen is not None
        and chosen is greedy
        and isinstance(getattr(kind, "remaining_jobs", None), property)
    ):
        scheduler.__class__ = type(kind.__name__, (kind,), {"remaining_jobs": ()})

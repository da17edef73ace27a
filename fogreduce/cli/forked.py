"""Work done in a forked process beside this one: validation on one core while the other imports libraries."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from typing import TypeVar

from fogreduce.errors import FogreduceError

Result = TypeVar("Result")


def in_a_fork(function: Callable[[], Result]) -> Callable[[], Result]:
    """Start `function` in a forked process; the call returned waits for its result.

    To be used before any thread is started. What the function raises on purpose (FogreduceError) is raised
    by the call returned. Where a process cannot fork, the function is called at that time instead.
    """
    if not hasattr(os, "fork"):
        return function
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        _answer(function, writing)
    os.close(writing)

    def result() -> Result:
        with os.fdopen(reading, "rb") as pipe:
            answer = pipe.read()
        os.waitpid(child, 0)
        if not answer:
            # It did not fail on purpose: do it again here, where what goes wrong can be seen.
            return function()
        good, value = pickle.loads(answer)
        if good:
            return value
        raise value

    return result


def _answer(function: Callable[[], object], writing: int) -> None:
    """In the child: the result or the error, pickled; nothing where the error was not meant."""
    try:
        answer = pickle.dumps((True, function()))
    except FogreduceError as error:
        answer = pickle.dumps((False, error))
    except BaseException:
        answer = b""
    try:
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(answer)
    finally:
        os._exit(0)

"""Telling that memory ran out, whichever library met it first, and saying so in one line."""

from __future__ import annotations

import errno

from fogreduce.errors import Fault

#: What is said by the loader of shared objects and by Python's threads, which raise no MemoryError.
_WORDS = ("failed to map segment", "can't start new thread", "cannot allocate memory", "unable to allocate")


def out_of_memory(error: BaseException | None) -> bool:
    """Whether an error, or one that led to it, says that there is no more memory."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        if any(words in str(error).lower() for words in _WORDS):
            return True
        error = error.__cause__ or error.__context__
    return False


def memory_fault(command: str) -> Fault:
    """What the user is told."""
    return Fault(
        f"fogreduce {command}", "", "no more memory", "a higher limit on memory (ulimit -v, or the job's own)"
    )

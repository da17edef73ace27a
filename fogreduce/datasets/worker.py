"""A thread that makes calls one after another, in the order given, beside the thread that gives them."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from types import TracebackType


class Worker:
    """Calls in order, in a thread of their own; the first error ends them and is raised for the giver.

    Parameters
    ----------
    waiting : int
        How many calls may wait; a further one waits for a place (so that memory stays flat).
    """

    def __init__(self, waiting: int) -> None:
        self._calls: queue.Queue[Callable[[], None] | None] = queue.Queue(waiting)
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def do(self, call: Callable[[], None]) -> None:
        """Give a call; raises what an earlier one raised."""
        self._calls.put(call)
        if self._error is not None:
            raise self._error

    def _work(self) -> None:
        while (call := self._calls.get()) is not None:
            if self._error is None:
                try:
                    call()
                except BaseException as error:  # handed to the thread that gave the call
                    self._error = error

    def close(self) -> None:
        """Wait for all calls; raises what one of them raised."""
        self._calls.put(None)
        self._thread.join()
        if self._error is not None:
            raise self._error

    def __enter__(self) -> Worker:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

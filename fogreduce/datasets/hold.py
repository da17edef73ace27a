"""Ctrl-C and the scheduler's end, held back while HDF5 works."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_DEFERRED = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def signals_held() -> Iterator[None]:
    """Let a signal that would stop the process wait until the block has ended (some milliseconds).

    HDF5 that is interrupted by an exception can neither go on nor let the process end in good order.
    Only the main thread handles signals; elsewhere nothing is to be done.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    met: list[int] = []
    before = {number: signal.getsignal(number) for number in _DEFERRED}
    for number, handler in before.items():
        if callable(handler):
            signal.signal(number, lambda number, frame: met.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            if callable(handler):
                signal.signal(number, handler)
    if met:
        signal.raise_signal(met[0])

"""A progress bar for commands that run for more than two seconds; none when output is piped."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_SILENT_S = 2.0


@contextmanager
def progress(total: int, unit: str) -> Iterator[Callable[[int], None]]:
    """Gives a function to tell how much of `total` is done; a bar appears after two seconds."""
    began = time.monotonic()
    bar: Any = None

    def told(done: int) -> None:
        nonlocal bar
        if bar is None:
            if not sys.stderr.isatty() or time.monotonic() - began < _SILENT_S:
                return
            from tqdm import tqdm

            # What was done before it appeared is left out of the speed, so that the time left is right.
            bar = tqdm(total=total, initial=done, unit=f" {unit}", unit_scale=True, leave=False)
        bar.update(done - bar.n)

    try:
        yield told
    finally:
        if bar is not None:
            bar.close()

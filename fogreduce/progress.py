"""A progress bar for commands that run for more than two seconds; none when output is piped."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

#: Seconds before a bar appears, and between two drawings of the bar of steps.
SILENT_S, TICK_S = 2.0, 0.5

#: Called with how much is done so far.
Progress = Callable[[int], None]


def silent(done: int) -> None:
    """Progress that nobody wants to see."""


@contextmanager
def progress(total: int, unit: str, began: float | None = None) -> Iterator[Progress]:
    """Gives a function to tell how much of `total` is done; a bar appears after two seconds.

    `began` is when the command did, by `time.monotonic`, where it had something else to do first.
    """
    began = time.monotonic() if began is None else began
    bar: Any = None

    def advance(done: int) -> None:
        nonlocal bar
        if bar is None:
            if not sys.stderr.isatty() or time.monotonic() - began < SILENT_S:
                return
            from tqdm import tqdm

            # What was done before it appeared is left out of the speed, so that the time left is right.
            bar = tqdm(total=total, initial=done, unit=f" {unit}", unit_scale=True, leave=False)
        bar.update(done - bar.n)

    try:
        yield advance
    finally:
        if bar is not None:
            bar.close()


@contextmanager
def steps(names: Sequence[str]) -> Iterator[Callable[[str], None]]:
    """Gives a function to tell which of the steps `names` begins; after two seconds a bar names it.

    For work whose steps are long and few: the time that has passed goes on while a step lasts.
    """
    if not sys.stderr.isatty():
        yield lambda name: None
        return
    done, current = threading.Event(), [0]

    def show() -> None:
        if done.wait(SILENT_S):
            return
        from tqdm import tqdm

        with tqdm(total=len(names), unit=" steps", leave=False) as bar:
            while True:
                bar.set_description_str(names[current[0]], refresh=False)
                bar.update(current[0] - bar.n)
                bar.refresh()
                if done.wait(TICK_S):
                    return

    def begin(name: str) -> None:
        current[0] = names.index(name)

    shown = threading.Thread(target=show, daemon=True)
    shown.start()
    try:
        yield begin
    finally:
        done.set()
        shown.join()

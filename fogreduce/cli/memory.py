"""Freed memory kept for the next block of records, where the C library is glibc."""

from __future__ import annotations

import ctypes

# Numbers of mallopt(3).
_TRIM_THRESHOLD, _TOP_PAD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -2, -3, -8


def keep_freed_memory() -> None:
    """Let freed blocks of some megabytes be used again, not handed back to the system after each use.

    The arrays of a block of records are made and freed over and over; each time the system would fill
    their pages with zeros anew, a tenth of the time of a reduction. To be called before threads are started.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):
        return  # another C library: it has its own way
    mallopt(_ARENA_MAX, 1)
    mallopt(_MMAP_THRESHOLD, 1 << 26)
    mallopt(_TRIM_THRESHOLD, 1 << 28)
    mallopt(_TOP_PAD, 1 << 25)

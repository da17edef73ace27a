"""Random streams: one for each purpose, so that adding a run, a gyro or an effect changes no other."""

from __future__ import annotations

import hashlib

import numpy as np


def stream(seed: int, *words: str) -> np.random.Generator:
    """A generator that depends on `seed` and `words` alone.

    The words (run, gyro, process ...) are hashed, each with its length, so that ``("a", "bc")`` and
    ``("ab", "c")`` are different streams.

    Parameters
    ----------
    seed : int
        Not negative; the user's.
    *words : str
        What the stream is for.
    """
    text = "".join(f"{len(word)}:{word}" for word in words)
    digest = hashlib.sha256(text.encode()).digest()
    key = [int.from_bytes(digest[k : k + 4], "little") for k in range(0, 32, 4)]
    return np.random.Generator(np.random.SFC64(np.random.SeedSequence(entropy=seed, spawn_key=key)))

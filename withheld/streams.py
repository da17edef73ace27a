"""Random streams: one for each purpose, so that adding one changes no other."""

import hashlib

import numpy as np


def stream(seed: int, *words: str) -> np.random.Generator:
    """A generator that depends on `seed` and `words` alone.

    The words (study, case, run, gyro, purpose) are hashed, so that a new run, gyro or effect leaves every
    other stream as it was.
    """
    digest = hashlib.sha256("\x1f".join(words).encode()).digest()
    key = [int.from_bytes(digest[4 * k : 4 * k + 4], "little") for k in range(4)]
    return np.random.default_rng(np.random.SeedSequence(entropy=seed, spawn_key=tuple(key)))

"""Random streams that belong to identities: to a car or a run by its name, never by its position.

So adding, removing or reordering others, and the number of workers, change nothing for anyone.
"""

import hashlib

import numpy as np


def stream(seed: int | np.random.SeedSequence, purpose: str, identity: str = "") -> np.random.Generator:
    """The generator for ``purpose`` of the one named ``identity`` under the master ``seed``."""
    master = seed if isinstance(seed, np.random.SeedSequence) else np.random.SeedSequence(seed)
    key = (*master.spawn_key, stable_hash(purpose), stable_hash(identity))
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(master.entropy, spawn_key=key)))


def stable_hash(text: str) -> int:
    """64 bits that are the same in every process and on every platform (``hash`` is salted)."""
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little")

"""A canonical hash of results: everything but how long they took, and on what they were computed."""

import hashlib
import json
import struct
from collections.abc import Mapping
from typing import Any

from arena.common.npz import Arrays
from arena.results.continuation import FREE
from arena.results.results import Results


def digest(results: Results) -> str:
    """The hash of all of ``results``; equal for two files if they hold the same tournament and bits.

    It covers the configuration, scores, statuses and arrays of all runs, whatever their order in the
    file; not the seconds, the driver, the versions, and the texts of errors.
    """
    config = {key: value for key, value in results.config.items() if key not in FREE}
    whole = hashlib.sha256(json.dumps(config, sort_keys=True).encode())
    for run in sorted(results.runs, key=lambda run: (run["entrant"], run["replicate"])):
        whole.update(run_digest(run, results.arrays(run["entrant"], run["replicate"])).encode())
    return whole.hexdigest()


def run_digest(scores: Mapping[str, Any], arrays: Arrays) -> str:
    """The hash of one run's identity, scores and arrays."""
    found = hashlib.sha256()
    for name in ("entrant", "replicate", "status", "accuracy", "mean_length", "iterations"):
        value = scores[name]
        told = struct.pack("<d", value) if isinstance(value, float) else repr(value).encode()
        found.update(name.encode() + b"\0" + told + b"\0")
    for name, array in sorted(arrays.items()):
        little = array.astype(array.dtype.newbyteorder("<"), copy=False)
        found.update(f"{name} {little.dtype.str} {little.shape}\0".encode() + little.tobytes())
    return found.hexdigest()

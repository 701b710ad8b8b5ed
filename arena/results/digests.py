"""A canonical hash of results: everything but how long they took, and on what they were computed."""

import hashlib
import json
import struct

from arena.common.npz import Arrays
from arena.common.plain import none_for_nan
from arena.results.continuation import MAY_CHANGE
from arena.results.records import RunRecord
from arena.results.results import Results
from arena.tournament.outcome import Outcome, Status


def digest(results: Results) -> str:
    """The hash of all of ``results``; equal for two files if they hold the same tournament and bits.

    It covers the configuration, scores, statuses and arrays of all runs, whatever their order in the
    file; not the seconds, the driver, the versions, and the texts of errors.
    """
    config = {key: value for key, value in results.config.items() if key not in MAY_CHANGE}
    whole = hashlib.sha256(json.dumps(config, sort_keys=True).encode())
    for record in sorted(results.records, key=lambda record: record.key):
        whole.update(run_digest(record, results.arrays(*record.key)).encode())
    return whole.hexdigest()


def run_digest(run: RunRecord | Outcome, arrays: Arrays) -> str:
    """The hash of one run's identity, scores and arrays."""
    digest = hashlib.sha256()
    for name in ("entrant", "replicate", "status", "accuracy", "mean_length", "iterations"):
        value = none_for_nan(getattr(run, name))
        value = str(value) if isinstance(value, Status) else value
        encoded = struct.pack("<d", value) if isinstance(value, float) else repr(value).encode()
        digest.update(name.encode() + b"\0" + encoded + b"\0")
    for name, array in sorted(arrays.items()):
        little = array.astype(array.dtype.newbyteorder("<"), copy=False)
        digest.update(f"{name} {little.dtype.str} {little.shape}\0".encode() + little.tobytes())
    return digest.hexdigest()

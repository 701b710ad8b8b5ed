"""Everything in results that must be the same bits, to compare."""

from typing import Any

from arena import Results

_SCORES = ["entrant", "replicate", "accuracy", "mean_length", "iterations", "status"]


def bits_of(results: Results) -> tuple[list[Any], dict[Any, Any]]:
    """Scores and arrays of all runs."""
    frame = results.frame()
    arrays = {}
    for entrant, replicate in zip(frame.entrant, frame.replicate):
        found = results.arrays(entrant, replicate)
        arrays[entrant, replicate] = {
            name: (array.dtype.str, array.shape, array.tobytes()) for name, array in found.items()
        }
    return frame[_SCORES].astype(object).where(frame[_SCORES].notna(), None).to_numpy().tolist(), arrays

"""Results as files for other programs."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from arena.results.results import Results
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    import pandas as pd

WHAT = ("runs", "episodes", "arrays")


def export(results: Results, what: str, path: Path) -> None:
    """Write ``what`` of the results to ``path``, in the format that its suffix says.

    Args:
        results: a tournament's.
        what: ``"runs"``, a row a run; ``"episodes"``, a row a training or test episode; or ``"arrays"``, all
            arrays of all finished runs, named ``entrant/replicate/name``.
        path: of the file: .csv, .json (records) or .parquet for rows, .npz for arrays.

    Raises:
        ValueError: when there is no such format, or the library that writes it is not installed.
    """
    choice("what", what, WHAT)
    suffixes = (".npz",) if what == "arrays" else (".csv", ".json", ".parquet")
    if path.suffix not in suffixes:
        raise InvalidValueError(f"the file of {what} must end in {' or '.join(suffixes)}, got {str(path)!r}")
    if what == "arrays":
        arrays = {
            f"{record.entrant}/{record.replicate}/{name}": array
            for record in results.records
            if record.finished
            for name, array in results.arrays(*record.key).items()
        }
        np.savez_compressed(path, allow_pickle=False, **arrays)
        return
    _write(results.frame() if what == "runs" else results.episodes(), path)


def _write(frame: "pd.DataFrame", path: Path) -> None:
    if path.suffix == ".csv":
        frame.to_csv(path, index=False, lineterminator="\n")
    elif path.suffix == ".json":
        frame.to_json(path, orient="records", indent=1)
    else:
        try:
            frame.map(_plain_cell).to_parquet(path, index=False)
        except ImportError:
            raise InvalidValueError(
                f"{path} needs pyarrow, which is not installed: pip install pyarrow"
            ) from None


def _plain_cell(value: object) -> object:
    """Parameters are of many kinds; a column of a Parquet file has one."""
    return value if isinstance(value, (str, int, float, bool, type(None), np.generic)) else str(value)

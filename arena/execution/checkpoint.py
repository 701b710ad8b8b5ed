"""Long runs saved in the middle: the agent's arrays, the random streams and the episodes done.

A checkpoint is a file beside the results file, written by the worker. It is an ``.npz`` of plain arrays
and a JSON text; nothing in it is executed. It is used only for the very run that wrote it, with the same
code.
"""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from arena.common.npz import pack, unpack
from arena.common.plain import plain
from arena.tournament.conditions import Conditions, Run
from envs.compilation.reachable import ReachableCode


class UnsavableError(TypeError):
    """The agent holds something else than numbers, texts, arrays and generators."""


@dataclass(frozen=True)
class Checkpoint:
    """The place for the state of one run in its middle, and what the state consists of.

    Args:
        path: of the file; None for a run that is not saved.
        key: what the run is; another run's file is not used.
        parts: the arrays and generators, changed in place as the run goes on.
    """

    path: Path | None
    key: str
    parts: tuple[Any, ...]

    def save(self, done: int) -> None:
        """Keep the state after ``done`` episodes; an earlier one is replaced as a whole."""
        if self.path is None:
            return
        metadata = {"key": self.key, "done": done, "generators": list(map(_generator, self.parts))}
        text = np.frombuffer(json.dumps(metadata).encode(), np.uint8)
        arrays = {str(n): part for n, part in enumerate(self.parts) if isinstance(part, np.ndarray)}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        draft = self.path.with_suffix(f".{os.getpid()}")
        draft.write_bytes(pack({"metadata": text, **arrays}))
        draft.replace(self.path)

    def restore(self) -> int:
        """Put the kept state back; the number of episodes that are done, 0 if nothing was kept."""
        if self.path is None:
            return 0
        try:
            arrays = unpack(self.path.read_bytes())
            metadata = json.loads(arrays.pop("metadata").tobytes())
        except Exception:  # missing, or damaged in any of many ways: begin anew
            return 0
        if metadata["key"] != self.key:
            return 0
        for number, (part, generator) in enumerate(zip(self.parts, metadata["generators"], strict=True)):
            if generator is None:
                part[...] = arrays[str(number)]
            else:
                part.bit_generator.state = generator
        return int(metadata["done"])


def checkpoint_of(conditions: Conditions, run: Run, agent: Any, *more: Any) -> Checkpoint:
    """The checkpoint of a run: of its agent and of ``more`` arrays and generators."""
    if conditions.checkpoints is None:
        return Checkpoint(None, "", ())
    try:
        parts = (*_parts(agent), *more)
    except UnsavableError:
        return Checkpoint(None, "", ())
    what = [run.identity, plain(conditions.hill), plain(vars(conditions.training)), conditions.seed]
    what += [run.entrant.to_dict(), ReachableCode(agent, conditions.hill).fingerprint()]
    key = hashlib.sha256(json.dumps(what).encode()).hexdigest()
    return Checkpoint(file_of(conditions, run), key, parts)


def file_of(conditions: Conditions, run: Run) -> Path | None:
    """Where the run is saved, if it is."""
    if conditions.checkpoints is None:
        return None
    return Path(conditions.checkpoints) / f"{hashlib.sha256(run.identity.encode()).hexdigest()[:32]}.npz"


def discard(conditions: Conditions, run: Run) -> None:
    """Remove the checkpoint of a run that is over, and the folder with the last of them."""
    path = file_of(conditions, run)
    if path is not None:
        path.unlink(missing_ok=True)
        with suppress(OSError):
            path.parent.rmdir()


def savable(agent: Any) -> bool:
    """Whether a run of the agent can be saved in its middle."""
    try:
        list(_parts(agent))
    except UnsavableError:
        return False
    return True


def _parts(value: Any) -> Iterator[Any]:
    """The arrays and generators that a named tuple consists of."""
    if isinstance(value, np.random.Generator):
        yield value
    elif isinstance(value, np.ndarray) and not value.dtype.hasobject:
        if value.flags.writeable:
            yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _parts(part)
    elif not isinstance(value, (bool, int, float, complex, str, bytes, Enum, np.generic, type(None))):
        raise UnsavableError(f"{type(value).__name__} cannot be saved")


def _generator(part: Any) -> Any:
    return part.bit_generator.state if isinstance(part, np.random.Generator) else None

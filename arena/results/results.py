"""Results of a tournament: scores as a table, arrays on demand."""

import copy
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from arena.common.html import represent
from arena.common.npz import Arrays
from arena.results.records import EntrantRecord, RunRecord, run_record
from arena.results.schema import replicates_of
from arena.results.store import ResultsError, Store
from arena.results.trained import Trained, UnknownPolicyError, restore
from arena.tournament.conditions import Conditions, Evaluation, Training
from envs.foundation.checks import choice, integer
from envs.foundation.errors import InvalidValueError
from envs.hill import Hill

if TYPE_CHECKING:
    import pandas as pd

_SCORES = ("accuracy", "mean_length", "steps", "iterations", "seconds", "driver", "status")


class Results:
    """What a tournament found: ``results.frame()`` has one row a run.

    Made by ``arena.run`` and ``arena.load``; the file is read once. Close it, or use it in a ``with``
    statement, to close its file.
    """

    def __init__(self, store: Store) -> None:
        self._store = store

    @property
    def path(self) -> Path | None:
        """The results file; None for one that is gone with this object."""
        return self._store.path

    @property
    def config(self) -> dict[str, Any]:
        """The tournament as plain values, see ``Tournament.to_dict``; a copy."""
        return copy.deepcopy(self._store.config)

    @property
    def versions(self) -> dict[str, str]:
        """Versions of Python and the packages that computed the results."""
        return self._store.versions

    @cached_property
    def conditions(self) -> Conditions:
        """What all runs of the tournament have in common.

        Raises:
            ResultsError: when the file is damaged.
        """
        config = self._store.config
        try:
            hill, training = Hill(**config["hill"]), Training(**config["training"])
            evaluation = Evaluation(**config["evaluation"])
        except (TypeError, ValueError) as error:  # other or wrong arguments
            raise ResultsError(f"{self.path} is damaged: {error}") from error
        return Conditions(hill, training, evaluation, config["seed"])

    @cached_property
    def entrants(self) -> Mapping[str, EntrantRecord]:
        """Those of the tournament, in its order, by name."""
        return {
            entrant["name"]: EntrantRecord(entrant["name"], entrant["agent"], entrant["parameters"])
            for entrant in self._store.config["entrants"]
        }

    @cached_property
    def records(self) -> tuple[RunRecord, ...]:
        """The runs, entrants in the tournament's order.

        Raises:
            ResultsError: when the file is damaged.
        """
        limit = self._store.config["evaluation"]["max_steps"]
        return tuple(run_record(row, self.entrants[row["entrant"]], limit) for row in self._store.rows())

    @property
    def max_replicates(self) -> int:
        """How many there may be of each entrant."""
        return replicates_of(self._store.config)

    @property
    def runs(self) -> list[dict[str, Any]]:
        """``records`` as plain values, NaN as None."""
        return [record.to_dict() for record in self.records]

    def frame(self) -> "pd.DataFrame":
        """The runs as a table: entrant, agent, a column a parameter, replicate and the scores.

        A parameter that an agent does not have is missing; lists are tuples, so that they group.
        """
        import pandas as pd

        names = list(dict.fromkeys(name for entrant in self.entrants.values() for name in entrant.parameters))
        rows = [
            {
                "entrant": record.entrant,
                "agent": record.agent,
                **{name: _cell(record.parameters.get(name)) for name in names},
                "replicate": record.replicate,
                **{name: getattr(record, name) for name in _SCORES},
                "status": str(record.status),
            }
            for record in self.records
        ]
        columns = ["entrant", "agent", *names, "replicate", *_SCORES]
        frame = pd.DataFrame(rows, columns=columns)
        return frame.astype(dict.fromkeys(("accuracy", "mean_length", "steps", "seconds"), float))

    def episodes(self) -> "pd.DataFrame":
        """A row an episode of the finished runs: entrant, replicate, phase, episode, steps and reached.

        ``phase`` is ``"training"`` or ``"test"``. Whether a training episode of as many steps as the limit
        reached the goal with the last of them is not kept: it is told as false.
        """
        import pandas as pd

        parts, limit = [], self.conditions.training.max_steps
        for record in self.records:
            if record.finished:
                arrays = self.arrays(*record.key)
                for phase, steps, reached in (
                    ("training", arrays["lengths"], arrays["lengths"] < limit),
                    ("test", arrays["test_lengths"], arrays["test_reached"]),
                ):
                    of = {"entrant": record.entrant, "replicate": record.replicate, "phase": phase}
                    numbers = {"episode": np.arange(len(steps)), "steps": steps, "reached": reached}
                    parts.append(pd.DataFrame(of | numbers))
        columns = ["entrant", "replicate", "phase", "episode", "steps", "reached"]
        return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)

    def arrays(self, entrant: str, replicate: int = 0) -> Arrays:
        """The arrays of a run, by name.

        They are the agent's own, such as ``values`` and ``visits``, and ``lengths`` (steps of each
        training episode), ``test_lengths`` and ``test_reached`` (one value a test episode).

        Raises:
            KeyError: when there is no such run.
        """
        return self._store.arrays(entrant, replicate)

    def finished_arrays(self, entrant: str, replicate: int = 0) -> Arrays:
        """The arrays of a run that finished.

        Raises:
            ValueError: when there is no such run.
            UnknownPolicyError: a ValueError; when it failed.
        """
        choice("entrant", entrant, self.entrants)
        try:
            arrays = self.arrays(entrant, integer("replicate", replicate, 0))
        except KeyError:
            raise InvalidValueError(
                f"replicate must be one that {entrant!r} has run, got {replicate}"
            ) from None
        if not arrays:
            raise UnknownPolicyError(f"replicate {replicate} of {entrant!r} failed: there is nothing to draw")
        return arrays

    def trained(self, entrant: str, replicate: int = 0) -> Trained:
        """The agent that a run trained; its ``policy`` drives elsewhere.

        Raises:
            ValueError: when there is no such run.
            UnknownPolicyError: a ValueError; when it failed, or its agent cannot be told from the file.
        """
        arrays = self.finished_arrays(entrant, replicate)
        record = self.entrants[entrant]
        return restore(entrant, record.agent, record.parameters, replicate, self.conditions, arrays)

    def best(self, count: int) -> list[str]:
        """The names of so many entrants: those with the fewest steps in their finished runs.

        Raises:
            ValueError: when no run has finished.
        """
        steps: dict[str, list[float]] = {}
        for record in self.records:
            if record.finished:
                steps.setdefault(record.entrant, []).append(record.steps)
        if not steps:
            raise InvalidValueError("no run has finished: there is nothing to draw")
        return sorted(steps, key=lambda name: float(np.mean(steps[name])))[:count]

    def to_dict(self) -> dict[str, Any]:
        """Everything but the arrays, as plain values; what ``arena show --json`` prints."""
        return {**self.config, "versions": self.versions, "runs": self.runs}

    def close(self) -> None:
        """Close the file."""
        self._store.close()

    def __enter__(self) -> "Results":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        return represent(self)

    def __repr__(self) -> str:
        total = self.max_replicates * len(self.entrants)
        return f"<Results of {self._store.config['name']!r}: {len(self.records)} of {total} runs>"


def load(path: str | Path, past: Iterable[str] = ()) -> Results:
    """The results in the file ``path``, only to be read.

    Args:
        path: of the file.
        past: former versions of entrants that are to be entrants, too: ``mine@old`` is the last one of
            ``mine``, whose code or parameters have been changed since.

    Raises:
        arena.results.ResultsError: a ValueError; when there is no such file or it is something else, or it
            has no such version.
    """
    return Results(Store.read(Path(path), past))


def _cell(value: Any) -> Any:
    if isinstance(value, Mapping):
        return ", ".join(f"{name}={part}" for name, part in value.items())
    return tuple(map(_cell, value)) if isinstance(value, list) else value

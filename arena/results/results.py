"""Results of a tournament: scores as a table, arrays on demand."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from arena.common.html import represent
from arena.common.npz import Arrays
from arena.results.store import Store
from arena.statistics.sequential import ADAPTIVE
from envs.foundation.errors import InvalidValueError

if TYPE_CHECKING:
    import pandas as pd

from agents import agent_class
from arena.results.trained import Trained, UnknownPolicyError
from arena.tournament.conditions import Conditions, Evaluation, Run, Training
from arena.tournament.entrant import Entrant
from arena.tournament.outcome import agent_arrays
from envs import Hill
from envs.foundation.checks import choice, integer
from envs.foundation.streams import stream

SCORES = ("accuracy", "mean_length", "iterations", "seconds", "driver", "status")
_COLUMNS = ("accuracy", "mean_length", "steps", "iterations", "seconds", "driver", "status")


class Results:
    """What a tournament found: ``results.frame()`` has one row a run.

    Made by ``arena.run`` and ``arena.load``. Close it, or use it in a ``with`` statement, to close
    its file.
    """

    def __init__(self, store: Store) -> None:
        self._store = store

    @property
    def path(self) -> Path | None:
        """The results file; None for one that is gone with this object."""
        return self._store.path

    @property
    def config(self) -> dict[str, Any]:
        """The tournament as plain values, see ``Tournament.to_dict``."""
        return self._store.config

    @property
    def versions(self) -> dict[str, str]:
        """Versions of Python and the packages that computed the results."""
        return self._store.versions

    @property
    def runs(self) -> list[dict[str, Any]]:
        """One dictionary a run, entrants in the tournament's order; plain values, NaN as None.

        To the scores of the paper it adds ``steps``: of all test episodes, those that failed counted at
        the limit.
        """
        limit = self.config["evaluation"]["max_steps"]
        entrants = {entrant["name"]: entrant for entrant in self.config["entrants"]}
        return [
            {
                "entrant": row["entrant"],
                "agent": entrants[row["entrant"]]["agent"],
                "parameters": entrants[row["entrant"]]["parameters"],
                "replicate": row["replicate"],
                **plain_scores(row),
                "steps": _steps(row["accuracy"], row["mean_length"], limit),
                **({"error": row["error"]} if row["error"] else {}),
            }
            for row in self._store.rows()
        ]

    def frame(self) -> "pd.DataFrame":
        """The runs as a table: entrant, agent, a column a parameter, replicate and the scores.

        A parameter that an agent does not have is missing; lists are tuples, so that they group.
        """
        import pandas as pd

        names = list(dict.fromkeys(n for e in self.config["entrants"] for n in e["parameters"]))
        rows = [
            {
                "entrant": run["entrant"],
                "agent": run["agent"],
                **{name: _cell(run["parameters"].get(name)) for name in names},
                "replicate": run["replicate"],
                **{name: run[name] for name in _COLUMNS},
            }
            for run in self.runs
        ]
        columns = ["entrant", "agent", *names, "replicate", *_COLUMNS]
        frame = pd.DataFrame(rows, columns=columns)
        return frame.astype(dict.fromkeys(("accuracy", "mean_length", "steps", "seconds"), float))

    def arrays(self, entrant: str, replicate: int = 0) -> Arrays:
        """The arrays of a run, by name.

        They are the agent's own, such as ``values`` and ``visits``, and ``lengths`` (steps of each
        training episode), ``test_lengths`` and ``test_reached`` (one value a test episode).

        Raises:
            KeyError: when there is no such run.
        """
        return self._store.arrays(entrant, replicate)

    def trained(self, entrant: str, replicate: int = 0) -> Trained:
        """The agent that a run trained; its ``policy`` drives elsewhere.

        Raises:
            ValueError: when there is no such run, or its agent cannot be told from the file.
        """
        return trained(self, entrant, replicate)

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
        config = self.config
        most = config["max_replicates"] if config["replicates"] == ADAPTIVE else config["replicates"]
        total = most * len(config["entrants"])
        return f"<Results of {config['name']!r}: {len(self._store.rows())} of {total} runs>"


def load(path: str | Path) -> Results:
    """The results in the file ``path``, only to be read.

    Raises:
        arena.results.store.ResultsError: a ValueError; when there is no such file or it is something else.
    """
    return Results(Store.read(Path(path)))


def plain_scores(row: Mapping[str, Any]) -> dict[str, Any]:
    """The scores of a run, NaN as None."""
    return {name: _none(row[name]) for name in SCORES}


def _none(value: Any) -> Any:
    return None if isinstance(value, float) and math.isnan(value) else value


def _steps(accuracy: float | None, mean_length: float | None, limit: int) -> float | None:
    """Mean steps, those that failed counted at the limit; None for a run that did not finish."""
    if accuracy is None or math.isnan(accuracy):
        return None
    share = accuracy / 100.0
    if share == 0.0:
        return float(limit)
    return None if mean_length is None else share * mean_length + (1.0 - share) * limit


def _cell(value: Any) -> Any:
    if isinstance(value, Mapping):
        return ", ".join(f"{name}={part}" for name, part in value.items())
    return tuple(map(_cell, value)) if isinstance(value, list) else value


_DRIVES = 3  # of the test that are driven again to see whether the agent is the one that was trained


def trained(results: Results, entrant: str, replicate: int = 0) -> Trained:
    """The agent that a run trained.

    It is made as it was for the run, then its arrays are filled with those in the file; and it must drive
    the first drives of the test in the steps that it took then.

    Args:
        results: of the tournament.
        entrant: its name.
        replicate: which of its runs.

    Raises:
        ValueError: when there is no such run.
        UnknownPolicyError: when the run failed, its agent is not installed, or it learned more than its
            arrays tell.
    """
    arrays = run_arrays(results, entrant, replicate)
    conditions = conditions_of(results)
    agent = _made_again(results, entrant, replicate, conditions)
    own = agent_arrays(agent)
    for name, array in own.items():
        if name not in arrays or arrays[name].shape != array.shape:
            raise UnknownPolicyError(f"{entrant!r} has other arrays than its agent has now: {name} differs")
        if array.flags.writeable:
            array[...] = arrays[name]
    found = Trained(entrant, replicate, agent, conditions, arrays["test_lengths"], arrays["test_reached"])
    for start, steps in zip(found.starts[:_DRIVES], found.test_lengths):
        if len(found.drive(float(start))) - 1 != steps:
            raise UnknownPolicyError(f"{entrant!r} has learned more than the arrays in its results tell")
    return found


def run_arrays(results: Results, entrant: str, replicate: int) -> Arrays:
    """The arrays of a finished run.

    Raises:
        ValueError: when there is no such run.
        UnknownPolicyError: when it failed.
    """
    choice("entrant", entrant, [one["name"] for one in results.config["entrants"]])
    try:
        arrays = results.arrays(entrant, integer("replicate", replicate, 0))
    except KeyError:
        raise InvalidValueError(f"replicate must be one that {entrant!r} has run, got {replicate}") from None
    if not arrays:
        raise UnknownPolicyError(f"replicate {replicate} of {entrant!r} failed: there is nothing to draw")
    return arrays


def conditions_of(results: Results) -> Conditions:
    """What all runs of the tournament have in common."""
    config = results.config
    return Conditions(
        Hill(**config["hill"]),
        Training(**config["training"]),
        Evaluation(**config["evaluation"]),
        config["seed"],
    )


def best_entrants(results: Results, count: int) -> list[str]:
    """The names of so many entrants: those with the fewest steps in their finished runs.

    Raises:
        ValueError: when no run has finished.
    """
    frame = results.frame()
    means = frame[frame["status"] == "finished"].groupby("entrant", sort=False)["steps"].mean()
    if means.empty:
        raise InvalidValueError("no run has finished: there is nothing to draw")
    return [str(name) for name in means.nsmallest(count).index]


def _made_again(results: Results, entrant: str, replicate: int, conditions: Conditions) -> Any:
    """The agent before it has learned anything."""
    table = next(one for one in results.config["entrants"] if one["name"] == entrant)
    try:
        run = Run(Entrant(entrant, agent_class(table["agent"]), **table["parameters"]), replicate)
        return run.entrant.create(conditions.hill, stream(conditions.seed, "create", run.identity))
    except Exception as error:  # of any kind: the agent's code is anybody's
        reason = " ".join(str(error).split())
        raise UnknownPolicyError(f"the agent of {entrant!r} cannot be made again: {reason}") from error

"""The agent that a run trained, made again from the arrays in the results file; nothing is trained."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents import agent_class
from arena.entrant import Entrant
from arena.outcome import Arrays, agent_arrays
from arena.policy import Policy
from arena.results import Results
from arena.tournament import Conditions, Evaluation, Run, Training
from envs import Hill
from envs.checks import choice, integer
from envs.streams import stream

_DRIVES = 3  # of the test that are driven again to see whether the agent is the one that was trained


class UnknownPolicyError(ValueError):
    """What a run has learned cannot be told from its results file; the message says why."""


@dataclass(frozen=True)
class Trained:
    """An agent as it was when its training ended.

    Attributes:
        entrant, replicate: which run.
        agent: to be asked for ``greedy``; not to be trained further, for its memory is not restored.
        conditions: of the tournament.
        test_lengths: steps of each test drive, int64, shape (episodes,).
        test_reached: whether it reached the goal, bool, shape (episodes,).
    """

    entrant: str
    replicate: int
    agent: Any
    conditions: Conditions
    test_lengths: NDArray[np.int64]
    test_reached: NDArray[np.bool_]

    @property
    def hill(self) -> Hill:
        """What it drives on."""
        return self.conditions.hill

    @property
    def policy(self) -> Policy:
        """What it has learned, for environments elsewhere: ``policy(observation)`` is the action."""
        return Policy(self.agent)

    @cached_property
    def starts(self) -> NDArray[np.float64]:
        """Positions where the test drives began, shape (episodes,)."""
        return self.conditions.start_states(self.replicate)[:, 0]

    def drive(self, position: float) -> NDArray[np.float64]:
        """A test drive from rest at ``position``: positions and velocities, shape (steps + 1, 2).

        It ends at the goal or at the limit of the test.
        """
        return drive(self.hill, self.agent, position, self.conditions.evaluation.max_steps)

    def _repr_html_(self) -> str:
        from arena.notebooks import trained_html

        return trained_html(self)


def drive(hill: Hill, agent: Any, position: float, limit: int) -> NDArray[np.float64]:
    """A drive by ``agent.greedy`` from rest at ``position``, until the goal or for ``limit`` steps.

    Returns:
        Positions and velocities, float64, shape (steps + 1, 2).
    """
    state, states = (position, 0.0), [(position, 0.0)]
    for _ in range(limit):
        state, _, terminated = hill.step(state, int(agent.greedy(hill.observe(state))))
        states.append(state)
        if terminated:
            break
    return np.array(states)


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
        raise ValueError(f"replicate must be one that {entrant!r} has run, got {replicate}") from None
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
        raise ValueError("no run has finished: there is nothing to draw")
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

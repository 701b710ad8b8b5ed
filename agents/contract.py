"""What the arena asks of an agent: the contract that a plugin author implements.

The shortest way is a ``typing.NamedTuple`` of numbers and arrays with plain methods::

    class MyAgent(NamedTuple):
        values: np.ndarray

        @classmethod
        def create(cls, task, *, bins=(20, 30)):
            ...

        def act(self, observation, progress, rng): ...
        def learn(self, observation, action, reward, next_observation, terminated): ...
        def greedy(self, observation): ...

If its methods keep to numba's subset of Python, the arena compiles them by itself. Any other class
with these methods races too, interpreted. Parts of an agent (a grid, a schedule) are named tuples
with plain methods as well. A field must not have the name of a method.
"""

import inspect
from collections.abc import Callable, Sequence
from typing import Any, Protocol, Self, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

TRANSITION = ("observation", "action", "reward", "next_observation", "terminated")
"""What ``learn`` gets, beside ``next_action`` if it asks for that."""

Observation = Sequence[float]
"""Indexed by dimension: a tuple of floats in compiled code, an array (float64) from the environment."""


class Task(Protocol):
    """What an agent may know before it drives; ``envs.Hill`` is one."""

    @property
    def low(self) -> tuple[float, ...]:
        """Least value of each dimension of an observation."""

    @property
    def high(self) -> tuple[float, ...]:
        """Greatest value of each dimension of an observation."""

    @property
    def n_actions(self) -> int:
        """Actions are 0, 1, ..., n_actions - 1."""


@runtime_checkable
class Agent(Protocol):
    """A driver that learns. Made fresh for each run.

    All randomness must come from the generators passed in; then a run is reproducible to the bit.
    """

    @classmethod
    def create(cls, task: Any, **parameters: Any) -> Self:
        """The agent before it has learned anything.

        The keyword-only arguments *are* the agent's parameters: their names, types and defaults
        are declared here and nowhere else. One named ``rng`` is no parameter: it receives the
        run's generator for what is random in the agent's making. Arrays that are fields of the
        agent are kept in the results.

        Args:
            task: bounds of the observations and number of actions, a ``Task``.
            parameters: keyword-only, by name.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule; one sentence that names it.
        """

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        """The behaviour policy: the action to take while learning.

        Args:
            observation: where the car is, an ``Observation``.
            progress: share of the training that is done, in [0, 1).
            rng: the run's random stream.
        """

    @property
    def learn(self) -> Callable[..., None]:
        """Learn from one transition.

        A method that takes, in this order, with ``next_action`` or without it,

        - ``observation``: where the car was;
        - ``action``: what it did there;
        - ``reward``: what it got for it;
        - ``next_observation``: where that led;
        - ``next_action``: what it does there;
        - ``terminated``: whether the goal was reached. A time limit does not terminate: the value of the
          next observation still counts.

        The parameter ``next_action`` decides when ``act`` is asked for it. If ``learn`` has it, before this
        update, also where the episode ends: so SARSA has it (Sutton & Barto 2018, 6.4). If not, after it, and
        only where a step follows: so Q-learning has it (6.5), which drives by what it has just learned.
        """

    def greedy(self, observation: Any) -> int:
        """The policy that is evaluated. It must not learn."""


def learns_with_next_action(agent: Any) -> bool:
    """Whether the agent's ``learn`` has the parameter ``next_action``, see ``Agent.learn``.

    One that calls it otherwise has it where it takes any number of arguments, or one more than without it.
    """
    try:
        signature = inspect.signature(agent.learn)
    except ValueError:  # not written in Python
        return True
    kinds = {parameter.kind for parameter in signature.parameters.values()}
    if "next_action" in signature.parameters or inspect.Parameter.VAR_POSITIONAL in kinds:
        return True
    try:
        signature.bind(*TRANSITION)
    except TypeError:
        return True
    return False


class HasEpisodes(Protocol):
    """An agent that wants to know when an episode begins; optional."""

    def begin_episode(self) -> None:
        """Called before the first ``act`` of each training episode."""

"""Action values linear in binary features, driven epsilon-greedily (Sutton & Barto 2018, 9.5, 10.1)."""

from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from agents.contract import Observation, Task
from agents.features import Features
from agents.policies import Table
from agents.schedules import LinearDecay

Active = NDArray[np.int64]
Memory = TypeVar("Memory")

_Common = tuple[Features, Table, float, float, LinearDecay, "Scratch"]


class Scratch(NamedTuple):
    """Room for the active features of two observations, int64, shape (active,) each."""

    here: Active
    there: Active


class Linear(NamedTuple, Generic[Memory]):
    """What the linear agents share: everything but ``create`` and ``learn``.

    The value of an action is the sum of the weights of the active features; ``weights`` has shape
    (features, actions).

    Attributes:
        step_size: alpha for one weight: the parameter ``step_size`` divided by the active features.
        memory: what the agent remembers of the episode.
    """

    features: Features
    weights: Table
    step_size: float
    discount: float
    epsilon: LinearDecay
    scratch: Scratch
    memory: Memory

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """Epsilon-greedy, equal values broken at random."""
        active = self.scratch.here
        self.features.fill(observation, active)
        return epsilon_greedy_of(self.weights, active, self.epsilon.at(progress), rng)

    def greedy(self, observation: Observation) -> int:
        """The action with the greatest value; of equal ones the lowest."""
        active = self.scratch.here
        self.features.fill(observation, active)
        return best_action_of(self.weights, active)


def common_parts(
    task: Task, features: Features, step_size: float, discount: float, epsilon: LinearDecay | float
) -> _Common:
    """The first fields of ``Linear``, before anything is learned: all weights are 0."""
    decay = epsilon if isinstance(epsilon, LinearDecay) else LinearDecay(epsilon, epsilon)
    weights = np.zeros((features.size, task.n_actions))
    scratch = Scratch(np.zeros(features.active, np.int64), np.zeros(features.active, np.int64))
    return features, weights, step_size / features.active, discount, decay, scratch


def value_of(weights: Table, active: Active, action: int) -> float:
    """The value of ``action`` where these features are active, Eq. (9.8)."""
    value = 0.0
    for i in range(active.shape[0]):
        value += weights[active[i], action]
    return value


def add(weights: Table, active: Active, action: int, change: float) -> None:
    """Change the weights of the active features, whose gradient is 1; that of all others is 0."""
    for i in range(active.shape[0]):
        weights[active[i], action] += change


def best_action_of(weights: Table, active: Active) -> int:
    """The action with the greatest value; of equal ones the lowest."""
    best, greatest = 0, value_of(weights, active, 0)
    for action in range(1, weights.shape[1]):
        value = value_of(weights, active, action)
        if value > greatest:
            best, greatest = action, value
    return best


def epsilon_greedy_of(weights: Table, active: Active, epsilon: float, rng: np.random.Generator) -> int:
    """With probability ``epsilon`` any action, else a best one, all equally likely."""
    if rng.random() < epsilon:
        return int(rng.random() * weights.shape[1])
    best, greatest, ties = 0, value_of(weights, active, 0), 1
    for action in range(1, weights.shape[1]):
        value = value_of(weights, active, action)
        if value > greatest:
            best, greatest, ties = action, value, 1
        elif value == greatest:
            ties += 1
            if rng.random() * ties < 1.0:  # each of the equal ones stays with probability 1 / ties
                best = action
    return best

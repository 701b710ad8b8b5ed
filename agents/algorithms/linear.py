"""Action values linear in binary features, driven epsilon-greedily (Sutton & Barto 2018, 9.5, 10.1)."""

from typing import Generic, NamedTuple, Self, TypeVar

import numpy as np

from agents.contract import Floats, Integers, Observation, Task
from agents.discretization.cells import Binning, Bins
from agents.discretization.features import Features, Tiles, make_features
from agents.learning.schedules import LinearDecay
from agents.parameters.declared import Count, Positive, Probability
from agents.parameters.validation import validated

Memory = TypeVar("Memory")


class Scratch(NamedTuple):
    """Room for the active features of two observations, int64, shape (active,) each."""

    here: Integers
    there: Integers


class LinearAgent(NamedTuple, Generic[Memory]):
    """What the linear agents share: everything but ``create`` and ``learn``.

    The value of an action is the sum of the weights of the active features; ``weights`` has shape
    (features, actions).

    Attributes:
        step_size: alpha for one weight: the parameter ``step_size`` divided by the active features.
        memory: what the agent remembers of the episode.
    """

    features: Features
    weights: Floats
    step_size: float
    discount: float
    epsilon: LinearDecay
    scratch: Scratch
    memory: Memory

    @classmethod
    def with_memory(cls, linear: "Linear", memory: Memory) -> Self:
        """The agent with all that ``linear`` has, and its memory."""
        features, weights, step_size, discount, epsilon, scratch, _ = linear
        return cls(features, weights, step_size, discount, epsilon, scratch, memory)

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


class Linear(LinearAgent[None]):
    """The weights of an agent, with its parameters; one that keeps more ``extends`` its ``create``."""

    __slots__ = ()

    @classmethod
    @validated
    def create(
        cls,
        task: Task,
        *,
        tilings: Count = 8,
        tiles: Tiles = 8,
        bins: Bins | None = None,
        binning: Binning = "uniform",
        step_size: Positive = 0.5,
        discount: Probability = 1.0,
        epsilon: LinearDecay | Probability = LinearDecay(0.0, 0.0),  # noqa: B008 (immutable)
        rng: np.random.Generator | None = None,
    ) -> Self:
        """The agent before it has learned anything; the defaults are the book's.

        Args:
            task: the hill.
            tilings: number of displaced grids of tiles.
            tiles: tiles of each along the range of each dimension.
            bins: cells in place of tiles, or their edges; see ``agents.discretization.cells.make_cells``.
            binning: of the cells: ``"uniform"``, ``"quantile"`` or ``"kmeans"``.
            step_size: alpha times the number of active features: 0.5 is the book's 0.5/8.
            discount: gamma, in [0, 1].
            epsilon: share of random actions; 0 explores as well, for weights of 0 are optimistic.
            rng: for cells that are learned.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        features = make_features(task, tilings, tiles, bins, binning, rng)
        weights, rate = np.zeros((features.size, task.n_actions)), step_size / features.active
        scratch = Scratch(*np.zeros((2, features.active), np.int64))
        return cls(features, weights, rate, discount, LinearDecay.of(epsilon), scratch, None)


def value_of(weights: Floats, active: Integers, action: int) -> float:
    """The value of ``action`` where these features are active, Eq. (9.8)."""
    value = 0.0
    for i in range(active.shape[0]):
        value += weights[active[i], action]
    return value


def add(weights: Floats, active: Integers, action: int, change: float) -> None:
    """Change the weights of the active features, whose gradient is 1; that of all others is 0."""
    for i in range(active.shape[0]):
        weights[active[i], action] += change


def best_action_of(weights: Floats, active: Integers) -> int:
    """The action with the greatest value; of equal ones the lowest."""
    best, greatest = 0, value_of(weights, active, 0)
    for action in range(1, weights.shape[1]):
        value = value_of(weights, active, action)
        if value > greatest:
            best, greatest = action, value
    return best


def epsilon_greedy_of(weights: Floats, active: Integers, epsilon: float, rng: np.random.Generator) -> int:
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

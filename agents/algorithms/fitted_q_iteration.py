"""Fitted Q iteration with randomized trees."""

from importlib.util import find_spec
from typing import NamedTuple, Self

import numpy as np

from agents.contract import Observation, Task
from agents.discretization.features import Tiles
from agents.discretization.grid import Grid
from agents.learning.action_values import best_action
from agents.learning.schedules import LinearDecay
from agents.models.batch import Batch
from agents.models.forest import Forest
from agents.parameters.declared import Count, Probability
from agents.parameters.validation import validated


class Fit(NamedTuple):
    """How a batch is fitted; see ``FittedQIteration.create``."""

    discount: float
    every: int
    growths: int
    iterations: int
    trees: int
    leaf: int


class FittedQIteration:
    """Collects steps and, every few episodes, fits the action values to all of them at once.

    A forest an action is fitted to the rewards and discounted values that the forests of the round
    before predict, from values of 0 on. The first forests are totally randomized; after so many
    ``iterations`` others are grown to the values found, and so on. The paper has both kinds, the first
    kept for all rounds, the second grown in each; here the second are kept for a while as well, which
    is ten times faster. The result is tabulated on a fine grid, by which the agent drives.

    It explores in phases of 1 to ``hold`` steps, for a car that trembles stays in the valley: in each it
    either holds a random action or drives greedily. Steps after the last fit are never learned, and
    none is before each action was taken. Runs interpreted.

    Attributes:
        cells: the fine grid.
        values: float64, shape (cells, actions): action values at the centres of the cells.
    """

    name = "fitted-q-iteration"
    citation = "Fitted Q iteration with randomized trees: Ernst, Geurts & Wehenkel 2005."

    def __init__(
        self,
        cells: Grid,
        n_actions: int,
        batch: Batch,
        fit: Fit,
        epsilon: LinearDecay,
        hold: int,
        rng: np.random.Generator,
    ) -> None:
        self.cells, self.batch, self.fit, self.epsilon, self.hold = cells, batch, fit, epsilon, hold
        self.rng = rng
        self.values = np.zeros((cells.size, n_actions))
        self.episodes = self.steps = 0
        self.phase, self.held = 0, -1  # steps left in this phase; the action that is held, -1 if none

    @classmethod
    @validated
    def create(
        cls,
        task: Task,
        *,
        discount: Probability = 0.99,
        epsilon: LinearDecay | Probability = LinearDecay(1.0, 0.0),  # noqa: B008 (immutable)
        hold: Count = 32,
        every: Count = 5,
        growths: Count = 5,
        iterations: Count = 100,
        trees: Count = 20,
        leaf: Count = 2,
        resolution: Tiles = 200,
        memory: Count = 20_000,
        rng: np.random.Generator | None = None,
    ) -> Self:
        """The agent before it has learned anything; the defaults are for some thirty episodes.

        Args:
            task: the hill.
            discount: gamma, in [0, 1].
            epsilon: share of the phases in which a random action is held.
            hold: steps of a phase at most; 1 is epsilon-greedy exploration.
            every: episodes between two fits.
            growths: times that trees are grown in a fit; with 1 all are totally randomized.
            iterations: rounds after each growth.
            trees: of a forest.
            leaf: steps in a leaf at least.
            resolution: cells of the fine grid along each dimension.
            memory: steps that are remembered.
            rng: seeds the trees.

        Raises:
            ImportError: when scikit-learn is not installed.
            TypeError, ValueError: when a parameter breaks its rule.
        """
        if find_spec("sklearn") is None:
            raise ImportError(
                "fitted Q iteration needs scikit-learn: pip install 'mountain-car-arena[trees]'"
            )
        return cls(
            Grid.over(task, resolution),
            task.n_actions,
            Batch.with_capacity(memory, len(task.low)),
            Fit(discount, every, growths, iterations, trees, leaf),
            LinearDecay.of(epsilon),
            hold,
            rng or np.random.default_rng(),
        )

    def begin_episode(self) -> None:
        """Fit the batch, if it is time."""
        batch = self.batch.first(self.steps)
        every_action = len(np.unique(batch.actions)) == self.values.shape[1]
        if every_action and self.episodes % self.fit.every == 0:
            self.tabulate(fitted(batch, self.fit, self.rng))
        self.episodes += 1
        self.phase = 0

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        """The action that is held, or the best one."""
        if self.phase == 0:
            self.phase = int(rng.integers(1, self.hold + 1))
            explores = rng.random() < self.epsilon.at(progress)
            self.held = int(rng.integers(self.values.shape[1])) if explores else -1
        self.phase -= 1
        return self.held if self.held >= 0 else self.greedy(observation)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        """Remember the step."""
        place = self.steps % len(self.batch.actions)
        self.batch.write(place, observation, action, reward, next_observation, terminated)
        self.steps += 1

    def greedy(self, observation: Observation) -> int:
        """The best action of the observation's cell in the fine grid."""
        return best_action(self.values, self.cells.encode(observation))

    def tabulate(self, forests: list[Forest]) -> None:
        """Write down what the forests predict for the centres of the cells."""
        low, high, bins = map(np.array, (self.cells.low, self.cells.high, self.cells.bins))
        places = np.stack(np.unravel_index(np.arange(self.cells.size), self.cells.bins), axis=1)
        centres = low + (places + 0.5) * (high - low) / bins
        for action, forest in enumerate(forests):
            self.values[:, action] = forest.predict(forest.leaves(centres))


def fitted(batch: Batch, fit: Fit, rng: np.random.Generator) -> list[Forest]:
    """The forests, one an action, after all rounds.

    Args:
        batch: steps; each action must be among them.
        fit: how to fit.
        rng: seeds the trees.
    """
    taken = [batch.actions == action for action in range(batch.actions.max() + 1)]
    forests: list[Forest] = []
    targets, next_values = rng.random(len(batch.actions)), np.zeros(len(batch.actions))
    for growth in range(fit.growths):
        tries = batch.observations.shape[1] if growth > 0 else 1  # the first targets mean nothing
        forests = [
            Forest(
                batch.observations[rows],
                targets[rows],
                tries,
                n_estimators=fit.trees,
                min_samples_leaf=fit.leaf,
                random_state=int(rng.integers(2**31)),
            )
            for rows in taken
        ]
        leaves = [forest.leaves(batch.next_observations) for forest in forests]
        for _ in range(fit.iterations):
            targets = batch.rewards + fit.discount * next_values * batch.goes_on
            for forest, rows in zip(forests, taken, strict=True):
                forest.fill(targets[rows])
            predictions = [forest.predict(rows) for forest, rows in zip(forests, leaves, strict=True)]
            next_values = np.max(predictions, axis=0)
    return forests

"""Fitted Q iteration with extremely randomized trees: Ernst, Geurts & Wehenkel 2005."""

from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from agents.contract import Observation, Task
from agents.features import Tiles
from agents.grid import Grid
from agents.parameters import Count, Probability, validated
from agents.policies import best_action
from agents.schedules import LinearDecay


class Batch(NamedTuple):
    """The latest steps, in a ring of as many places.

    Attributes:
        observations: float64, shape (places, dimensions).
        actions: int64, shape (places,).
        rewards: float64, shape (places,).
        next_observations: float64, shape (places, dimensions).
        going_on: bool, shape (places,): whether the step did not reach the goal.
    """

    observations: NDArray[np.float64]
    actions: NDArray[np.int64]
    rewards: NDArray[np.float64]
    next_observations: NDArray[np.float64]
    going_on: NDArray[np.bool_]


class FittedQIteration:
    """Collects steps, and now and then fits trees to all of them at once.

    A round fits one forest an action to the rewards and discounted values of what followed, as the
    forests of the round before tell them; the first round knows no values. The result is tabulated on
    a fine grid, by which the agent drives. It explores in phases of 1 to ``hold`` steps; in a phase it
    holds a random action or drives greedily. Steps after the last fit are not learned.

    Attributes:
        cells: the fine grid.
        values: float64, shape (cells, actions): the action values at the centres of the cells.
    """

    def __init__(
        self,
        task: Task,
        cells: Grid,
        batch: Batch,
        discount: float,
        epsilon: LinearDecay,
        hold: int,
        every: int,
        iterations: int,
        forest: dict[str, int],
        rng: np.random.Generator,
    ) -> None:
        self.cells, self.batch, self.discount, self.epsilon = cells, batch, discount, epsilon
        self.hold, self.every, self.iterations, self.forest, self.rng = hold, every, iterations, forest, rng
        self.n_actions = task.n_actions
        self.values = np.zeros((cells.size, task.n_actions))
        self.episodes = self.steps = 0
        self.phase, self.held = 0, -1

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
        iterations: Count = 50,
        trees: Count = 20,
        leaf: Count = 5,
        resolution: Tiles = 200,
        memory: Count = 20_000,
        rng: np.random.Generator | None = None,
    ) -> Self:
        decay = epsilon if isinstance(epsilon, LinearDecay) else LinearDecay(epsilon, epsilon)
        shape = (memory, len(task.low))
        batch = Batch(
            np.zeros(shape),
            np.zeros(memory, np.int64),
            np.zeros(memory),
            np.zeros(shape),
            np.zeros(memory, np.bool_),
        )
        forest = {"n_estimators": trees, "min_samples_leaf": leaf}
        cells = Grid.over(task, resolution)
        return cls(
            task,
            cells,
            batch,
            discount,
            decay,
            hold,
            every,
            iterations,
            forest,
            rng or np.random.default_rng(),
        )

    def begin_episode(self) -> None:
        if self.episodes > 0 and self.episodes % self.every == 0:
            self.fit()
        self.episodes += 1
        self.phase = 0

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:
        if self.phase == 0:
            self.phase = int(rng.integers(1, self.hold + 1))
            explores = rng.random() < self.epsilon.at(progress)
            self.held = int(rng.integers(self.n_actions)) if explores else -1
        self.phase -= 1
        return self.held if self.held >= 0 else self.greedy(observation)

    def learn(
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        place, b = self.steps % len(self.batch.actions), self.batch
        b.observations[place], b.actions[place], b.rewards[place] = observation, action, reward
        b.next_observations[place], b.going_on[place] = next_observation, not terminated
        self.steps += 1

    def greedy(self, observation: Observation) -> int:
        return best_action(self.values, self.cells.encode(observation))

    def fit(self) -> None:
        import time

        t = time.time()
        from sklearn.ensemble import ExtraTreesRegressor

        n = min(self.steps, len(self.batch.actions))
        b = Batch(*(x[:n] for x in self.batch))
        following = np.zeros(n)
        for _ in range(self.iterations):
            targets = b.rewards + self.discount * following * b.going_on
            forests = []
            for a in range(self.n_actions):
                m = b.actions == a
                f = ExtraTreesRegressor(**self.forest, random_state=int(self.rng.integers(2**31)), n_jobs=1)
                forests.append(f.fit(b.observations[m], targets[m]))
            following = np.max([f.predict(b.next_observations) for f in forests], axis=0)
        lo, hi = np.array(self.cells.low), np.array(self.cells.high)
        k = np.stack(np.unravel_index(np.arange(self.cells.size), self.cells.bins), 1)
        centres = lo + (k + 0.5) * (hi - lo) / np.array(self.cells.bins)
        self.values[:] = np.stack([f.predict(centres) for f in forests], 1)
        print(f"   fit {n} {time.time() - t:.1f}s", end="")

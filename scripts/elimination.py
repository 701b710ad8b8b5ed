"""Which departures from the paper's text explain its Table 2? All, with each of them left out in turn.

    python scripts/elimination.py --replicates 10
    python scripts/elimination.py --rows all "without the wall" --replicates 40 --seed 1

runs the paper's tournament under the reading ``as-run``, then with each of its five departures from the
text taken back, and with other choices that the text leaves open, and prints a Markdown table
(docs/readings.md). ``chance`` and chi-square are explained in ``arena.reproduction.Fit``: a reading that is
the paper's protocol has an error of ``chance``, and a chi-square of 1.
"""

import argparse
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from agents import HarmonicRate, QLearning, Sarsa
from agents.algorithms.tabular import Tabular, TabularAgent
from agents.contract import Floats, Observation
from agents.learning.targets import greatest_value
from agents.parameters import extends
from arena import Entrant, Evaluation, Results, Tournament, Training, run
from arena.reproduction import fit, published
from arena.tournament.readings import READINGS
from envs import Hill

BINS = [key[1:] for key in published() if key[0] == "sarsa"]
ITERATIONS = [row[2] for row in published().values()]
CENTRE = -math.pi / 6.0


class EarlyQLearning(Tabular):
    """Q-learning whose next action is drawn before the update."""

    __slots__ = ()

    def learn(  # noqa: D102 (as the contract has it)
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        next_action: int,
        terminated: bool,
    ) -> None:
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        next_value = greatest_value(self.values, next_cell)
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)


class Draws(NamedTuple):
    """What ``AnewSarsa`` draws with: the share of the training that is done, and a generator."""

    progress: Floats
    rng: np.random.Generator


class AnewSarsa(TabularAgent[Draws]):
    """SARSA that learns with an action a', and draws another one to do."""

    __slots__ = ()

    @classmethod
    @extends(Tabular.create)
    def create(cls, table: Tabular, *, rng: np.random.Generator | None = None) -> "AnewSarsa":  # noqa: D102
        return cls.with_memory(table, Draws(np.zeros(1), rng or np.random.default_rng()))

    def act(self, observation: Observation, progress: float, rng: np.random.Generator) -> int:  # noqa: D102
        self.memory.progress[0] = progress
        return self.policy.choose(self.values, self.visits, self.cells.encode(observation), progress, rng)

    def learn(  # noqa: D102
        self,
        observation: Observation,
        action: int,
        reward: float,
        next_observation: Observation,
        terminated: bool,
    ) -> None:
        cell, next_cell = self.cells.encode(observation), self.cells.encode(next_observation)
        progress, rng = self.memory.progress[0], self.memory.rng
        next_action = self.policy.choose(self.values, self.visits, next_cell, progress, rng)
        next_value = self.values[next_cell, next_action]
        self.update.apply(self.values, self.visits, cell, action, reward, next_value, terminated)


def best_of_ties(values: Floats, cell: int, rng: np.random.Generator) -> int:
    """The best action in ``cell``; of equal ones any."""
    best, ties = 0, 1
    for action in range(1, values.shape[1]):
        if values[cell, action] > values[cell, best]:
            best, ties = action, 1
        elif values[cell, action] == values[cell, best]:
            ties += 1
            if rng.random() * ties < 1.0:
                best = action
    return best


class DrawsTies:
    """Mixin of a table's agent that draws among equally good actions while it learns."""

    __slots__ = ()

    def act(self: Any, observation: Observation, progress: float, rng: np.random.Generator) -> int:  # noqa: D102
        if rng.random() < self.policy.epsilon.at(progress):
            return int(rng.random() * self.values.shape[1])
        return best_of_ties(self.values, self.cells.encode(observation), rng)


class TiesQLearning(DrawsTies, QLearning):
    """Q-learning that does."""

    __slots__ = ()


class TiesSarsa(DrawsTies, Sarsa):
    """SARSA that does."""

    __slots__ = ()


class Row(NamedTuple):
    """A protocol: what it changes in the reading ``as-run``.

    Attributes:
        hill: constants.
        parameters: of the agents.
        q_learning, sarsa: the agents.
        digitized: dimensions, 0 the position and 1 the velocity, whose cells lie between n edges.
        same_cells: whether these are the paper's hill's, wherever this one ends.
        reading: that is changed.
    """

    hill: dict[str, Any] = {}  # noqa: RUF012 (immutable in use)
    parameters: dict[str, Any] = {}  # noqa: RUF012
    q_learning: type[Any] = QLearning
    sarsa: type[Any] = Sarsa
    digitized: tuple[int, ...] = (0, 1)
    same_cells: bool = False
    reading: str = "as-run"

    def tournament(self, replicates: int, seed: int, training: Training) -> Tournament:
        """The paper's, under this protocol."""
        reading = READINGS[self.reading]  # taken apart here: as a reading it would take nothing back
        hill = Hill()._replace(**{**reading.hill, **self.hill})
        agents = {"q-learning": self.q_learning, "sarsa": self.sarsa}
        entrants = [
            Entrant(
                f"{name} {n_p}x{n_v}",
                agent,
                **{**reading.parameters, **self.cells(n_p, n_v), **self.parameters},
            )
            for name, agent in agents.items()
            for n_p, n_v in BINS
        ]
        return Tournament(
            tuple(entrants), hill, training, Evaluation(1, 1), replicates=replicates, seed=seed, name="row"
        )

    def cells(self, *bins: int) -> dict[str, Any]:
        """The parameters of the grid."""
        if self.digitized == (0, 1) and not self.same_cells:
            return {"bins": bins}
        if not self.digitized:
            return {"bins": bins, "binning": "uniform"}
        edges = [
            [*np.linspace(low, high, n), 2.0 * high] if d in self.digitized else np.linspace(low, high, n + 1)
            for d, (low, high, n) in enumerate(zip(Hill().low, Hill().high, bins, strict=True))
        ]
        return {"bins": tuple(tuple(map(float, row)) for row in edges), "binning": "uniform"}


def starting(half: float) -> dict[str, float]:
    """Starts around the bottom of the valley."""
    return {"min_start": CENTRE - half, "max_start": CENTRE + half}


ROWS: dict[str, Row] = {
    "all": Row(),
    "without the order of Q-learning: it draws before its update": Row(q_learning=EarlyQLearning),
    "without the wall: it stops the car": Row(hill={"inelastic_wall": True}),
    "without the reward of 0 at the goal": Row(hill={"goal_reward": -1.0}),
    "without the goal's cell: nothing follows it": Row(parameters={"goal": "terminal"}),
    "without the edges: n cells": Row(digitized=()),
    "without them in position": Row(digitized=(1,)),
    "without them in velocity": Row(digitized=(0,)),
    "SARSA draws a' anew": Row(sarsa=AnewSarsa),
    "start at -pi/6": Row(hill=starting(0.0)),
    "start within 0.1 of -pi/6": Row(hill=starting(0.1)),
    "n counts a visit once an episode": Row(parameters={"count_visits": "episode"}),
    "C = 0.02": Row(parameters={"step_size": HarmonicRate(C=0.02)}),
    "`literal`": Row(reading="literal"),
    "positions and grid end at pi/6": Row(hill={"max_position": -CENTRE}),
    "n counts the visit, too": Row(parameters={"step_size": HarmonicRate(B=10.01)}),
    "any of equally good actions": Row(q_learning=TiesQLearning, sarsa=TiesSarsa),
    "table from U(-1, 0)": Row(parameters={"initial_values": (-1.0, 0.0)}),
    "table from U(-2, 0)": Row(parameters={"initial_values": (-2.0, 0.0)}),
    "positions end at pi/6, the grid does not": Row(hill={"max_position": -CENTRE}, same_cells=True),
    "the velocity has no limits": Row(hill={"min_velocity": -1.0, "max_velocity": 1.0}, same_cells=True),
}


def iterations_of(tournament: Tournament, results: Results) -> Floats:
    """Those of each entrant, in its order, and each replicate; shape (entrants, replicates)."""
    iterations = np.zeros((len(tournament.entrants), results.max_replicates))
    places = {entrant.name: place for place, entrant in enumerate(tournament.entrants)}
    for record in results.records:
        iterations[places[record.entrant], record.replicate] = record.iterations
    return iterations


def lines(names: list[str], replicates: int, seed: int, episodes: int, jobs: int) -> Iterator[str]:
    """The lines of the table, one by one."""
    yield "| reading | replicates | root mean square | correlation | mean | chance | chi² / 32 |"
    yield "|---|---:|---:|---:|---:|---:|---:|"
    for name in names:
        tournament = ROWS[name].tournament(replicates, seed, Training(episodes))
        with run(tournament, n_jobs=jobs) as results:
            found = fit(iterations_of(tournament, results), ITERATIONS)
        yield (
            f"| {name} | {replicates} | {found.error:.2f}% | {found.correlation:.3f} "
            f"| {found.difference:+.1f}% | {found.chance:.2f}% | {found.chi_square:.2f} |"
        )


def main() -> None:
    """Parse, run, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--replicates", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--rows", nargs="+", metavar="START", default=[""], help="only those that begin so")
    parser.add_argument("--episodes", type=int, default=Training.episodes, help="fewer to try it out")
    parser.add_argument("--jobs", type=int, default=-1)
    arguments = parser.parse_args()
    if arguments.replicates < 2:
        parser.error(f"--replicates must be at least 2, got {arguments.replicates}")
    names = [name for name in ROWS if name.startswith(tuple(arguments.rows))]
    if not names:
        parser.error(f"--rows must be among {'; '.join(ROWS)}; got {'; '.join(arguments.rows)}")
    for line in lines(names, arguments.replicates, arguments.seed, arguments.episodes, arguments.jobs):
        print(line, flush=True)


if __name__ == "__main__":
    main()

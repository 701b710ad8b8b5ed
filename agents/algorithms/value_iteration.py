"""Value iteration on the digitized hill: what a grid can do without any learning.

Value iteration: R. Bellman 1957; Sutton & Barto 2018, section 4.4. Why its policy need not be the best one on
the grid: M. Littman, Memoryless policies: theoretical limitations and practical results, 1994.
"""

from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from annotated_types import Ge

from agents.baselines import DoesNotLearn
from agents.contract import Floats, Integers, Observation
from agents.discretization.cells import Binning, Bins, Cells, make_cells
from agents.learning.action_values import best_action
from agents.models.cell_model import CellModel
from agents.parameters.declared import Count, Probability
from agents.parameters.validation import validated
from envs.compilation.kernels import compile_loop

_SWEEPS, _TOLERANCE = 5000, 1e-6  # of value iteration
_HOPELESS = -1e6  # value of a cell without points
_ROBERTS = 0.7548776662466927, 0.5698402909980532  # steps of a sequence of even points (Roberts 2018)
_STARTS, _PATIENCE = 100, 500  # of the drives by which a policy is judged


class _Plan(NamedTuple):
    cells: Cells
    values: Floats
    policy: Integers


class ValueIteration(DoesNotLearn, _Plan):
    """Knows the hill but sees cells: drives by the solution of the digitized model. It learns nothing.

    In the digitized model the car is, in each step anew, anywhere in its cell, all places equally likely.
    Of that model this is the best policy. It need not be the best one that these cells allow on the hill,
    where a car is not anywhere but where it came in: the coarser the grid, the more a learner may find that
    the model does not show. With ``polish`` the policy is improved on the hill itself: the action of one
    cell after the other is changed, and the change is kept if drives become shorter on average. That ends
    where no change of a single cell helps: good, perhaps not the best.

    Attributes:
        cells: what divides the observations.
        values: of the digitized model, shape (cells, actions).
        policy: the action in each cell, shape (cells,).
    """

    __slots__ = ()
    name = "value-iteration"
    citation = "Planning on the digitized hill: what a grid can do without any learning."

    @classmethod
    @validated
    def create(
        cls,
        task: Any,
        *,
        bins: Bins = (20, 30),
        binning: Binning = "uniform",
        samples: Count = 100,
        discount: Probability = 1.0,
        polish: Annotated[int, Ge(0)] = 0,
        rng: np.random.Generator | None = None,
    ) -> Self:
        """The agent, with its plan.

        Args:
            task: the hill, whose ``reset`` and ``step`` it may use.
            bins: cells along position and velocity, or their edges; see ``agents.make_cells``.
            binning: ``"uniform"``, ``"quantile"`` or ``"kmeans"``.
            samples: points in a cell, on average, by which the model is estimated.
            discount: gamma, in [0, 1].
            polish: times that the action of every cell is tried to be changed, at most.
            rng: draws the starts to polish with, and drives for cells that are learned.

        Raises:
            TypeError, ValueError: when a parameter breaks its rule.
        """
        rng = rng or np.random.default_rng()
        cells = make_cells(task, bins, binning, rng)
        shape = (cells.size, task.n_actions)
        values, visits, state_values = np.zeros(shape), np.zeros(shape, np.int64), np.zeros(cells.size + 1)
        model = CellModel.empty(*shape)
        arguments = (task, cells, model, samples * cells.size, discount, values, visits, state_values)
        compile_loop(plan, *arguments)(*arguments)
        policy = np.array([best_action(values, cell) for cell in range(cells.size)], np.int64)
        if polish:
            starts = np.array([task.reset(rng) for _ in range(_STARTS)])
            search = (task, cells, starts, polish, shape[1], policy, np.zeros(cells.size, np.int64))
            compile_loop(improve, *search)(*search)
        return cls(cells, values, policy)

    def greedy(self, observation: Observation) -> int:
        """The planned action of the observation's cell."""
        return int(self.policy[self.cells.encode(observation)])


def plan(
    hill: Any,
    cells: Cells,
    model: CellModel,
    points: int,
    discount: float,
    values: Floats,
    visits: Integers,
    state_values: Floats,
) -> None:
    """Estimate the model, and solve it by value iteration in place (Gauss-Seidel).

    Args:
        hill: what is digitized.
        cells: of observations with two dimensions, bounded by ``hill``.
        model: filled.
        points: where each action is tried, spread evenly over all cells.
        discount: gamma.
        values: filled, shape (cells, actions).
        visits: filled with how often each action was tried in each cell, shape (cells, actions).
        state_values: filled with the best value of each cell; that of the goal is 0. Shape (cells + 1,).
    """
    n_cells, n_actions = values.shape
    for point in range(points):
        x, v = (0.5 + point * _ROBERTS[0]) % 1.0, (0.5 + point * _ROBERTS[1]) % 1.0
        state = (
            hill.min_position + x * (hill.goal_position - hill.min_position),
            hill.min_velocity + v * (hill.max_velocity - hill.min_velocity),
        )
        cell = cells.encode(hill.observe(state))
        for action in range(n_actions):
            after, reward, terminated = hill.step(state, action)
            successor = n_cells if terminated else cells.encode(hill.observe(after))
            model.observe(cell * n_actions + action, reward, successor)
            visits[cell, action] += 1
    for cell in range(n_cells):
        if visits[cell, 0] == 0:
            state_values[cell] = _HOPELESS
    sweeps, greatest = 0, 1.0
    while sweeps < _SWEEPS and greatest > _TOLERANCE:
        sweeps, greatest = sweeps + 1, 0.0
        for cell in range(n_cells):
            if visits[cell, 0] > 0:
                greatest = max(greatest, model.backup(values, visits, state_values, cell, 1, discount))


def improve(
    hill: Any, cells: Cells, starts: Floats, rounds: int, n_actions: int, policy: Integers, passed: Integers
) -> None:
    """Change the action of one cell after the other where that makes drives shorter.

    Args:
        hill: what is driven on.
        cells: what divides the observations.
        starts: states, shape (starts, 2).
        rounds: times that all cells are tried, at most.
        n_actions: how many there are.
        policy: the action in each cell, shape (cells,); changed in place.
        passed: room for a number in each cell.
    """
    shortest, better = total_steps(hill, cells, starts, policy, passed), True
    for _ in range(rounds):
        if not better:
            break
        better = False
        for cell in range(policy.shape[0]):
            if passed[cell] == 0:
                continue
            kept = policy[cell]
            for action in range(n_actions):
                if action == kept:
                    continue
                policy[cell] = action
                steps = total_steps(hill, cells, starts, policy, passed)
                if steps < shortest:
                    shortest, kept, better = steps, action, True
            policy[cell] = kept
            total_steps(hill, cells, starts, policy, passed)


def total_steps(hill: Any, cells: Cells, starts: Floats, policy: Integers, passed: Integers) -> int:
    """The steps of drives from all starts; ``passed`` is filled with those taken in each cell."""
    passed[:] = 0
    total = 0
    for start in range(starts.shape[0]):
        state, steps, terminated = (starts[start, 0], starts[start, 1]), 0, False
        while steps < _PATIENCE and not terminated:
            cell = cells.encode(hill.observe(state))
            passed[cell] += 1
            state, _, terminated = hill.step(state, policy[cell])
            steps += 1
        total += steps
    return total

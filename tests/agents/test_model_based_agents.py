"""What the agents with a model share, and all of them in the arena."""

from typing import Any

import numpy as np
import pytest
from chain import Chain, chain_values, drive_chain
from compiled_agents import KINDS, assert_allocates_nothing, assert_same_bits_from_both_drivers

from agents import Softmax
from agents.algorithms.dyna_q import DynaQ
from agents.algorithms.fitted_q_iteration import FittedQIteration
from agents.algorithms.prioritized_sweeping import PrioritizedSweeping
from agents.algorithms.r_max import RMax
from agents.parameters import parameters_of
from envs import Hill


@pytest.mark.parametrize("discount", [0.5, 0.9, 1.0])
@pytest.mark.parametrize(
    ("cls", "parameters"),
    [
        (RMax, {"known": 1, "tolerance": 0.0}),
        (RMax, {"known": 3, "tolerance": 0.0}),
        (PrioritizedSweeping, {"threshold": 0.0, "epsilon": 1.0}),
    ],
)
def test_values_of_a_chain_are_exact(cls: type[Any], parameters: dict[str, Any], discount: float) -> None:
    agent = cls.create(Chain(), bins=5, discount=discount, rng=np.random.default_rng(1), **parameters)
    drive_chain(agent, 30)
    assert agent.values == pytest.approx(chain_values(discount), rel=1e-12)
    assert [agent.greedy((cell + 0.5,)) for cell in range(5)] == [1] * 5


@pytest.mark.parametrize("cls", [PrioritizedSweeping, RMax])
def test_model_has_no_parameters_of_learning_step_by_step(cls: type[Any]) -> None:
    assert not {"step_size", "count_visits", "goal"} & parameters_of(cls)[0].keys()
    with pytest.raises(ValueError, match=r"^parameter of \w+ must be one of .*, got 'step_size'"):
        cls.create(Hill(), step_size=0.5)


@pytest.mark.parametrize(
    ("cls", "parameter", "bad"),
    [
        (DynaQ, "planning", -1),
        (DynaQ, "curiosity", -0.1),
        (PrioritizedSweeping, "planning", -1),
        (PrioritizedSweeping, "threshold", -0.1),
        (RMax, "known", 0),
        (RMax, "sweeps", 0),
        (RMax, "tolerance", -1.0),
        (RMax, "bins", 0),
        (FittedQIteration, "trees", 0),
        (FittedQIteration, "hold", 0),
        (FittedQIteration, "discount", 1.5),
    ],
)
def test_bad_parameter_is_refused_by_name(cls: type[Any], parameter: str, bad: Any) -> None:
    with pytest.raises(ValueError, match=f"^{parameter} must "):
        cls.create(Hill(), **{parameter: bad})


EDGES = [[-1.2, -0.7, -0.5, -0.45, 0.6], [-0.07, -0.01, 0.0, 0.002, 0.07]]


COMPILED: list[tuple[type[Any], dict[str, Any]]] = [
    (DynaQ, {"bins": (4, 5), "binning": "kmeans", "curiosity": 0.1}),
    (PrioritizedSweeping, {"bins": EDGES, "explore": Softmax()}),
    (RMax, {"bins": (4, 5), "known": 2}),
]


@pytest.mark.exhaustive
@pytest.mark.parametrize(("cls", "parameters"), COMPILED, ids=[cls.__name__ for cls, _ in COMPILED])
def test_compiled_agents_allocate_nothing_and_leave_the_interpreters_bits(
    cls: type[Any], parameters: dict[str, Any]
) -> None:
    assert_same_bits_from_both_drivers(cls, parameters)
    assert_allocates_nothing(cls, parameters)


@pytest.mark.exhaustive
@pytest.mark.parametrize("cls", [DynaQ, PrioritizedSweeping, RMax])
@pytest.mark.parametrize("kind", KINDS, ids=["uniform", "quantile", "kmeans"])
def test_every_kind_of_cells_and_of_exploration(cls: type[Any], kind: dict[str, Any]) -> None:
    given = {name: value for name, value in kind.items() if name in parameters_of(cls)[0]}
    limit = (
        40 if cls is RMax and "binning" not in kind else 60
    )  # some of its episodes reach the goal, not all
    assert_same_bits_from_both_drivers(cls, given, limit)
    assert_allocates_nothing(cls, given)

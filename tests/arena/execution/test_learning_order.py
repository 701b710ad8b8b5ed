"""When an agent is asked for its next action: before it learns, as SARSA's books have it, or after."""

from typing import Any, NamedTuple, Self

import numpy as np
import pytest
from numpy.typing import NDArray

from agents import QLearning, Sarsa
from agents.baselines import DoesNotLearn
from agents.contract import learns_with_next_action
from agents.registry import BUILT_IN
from arena import Entrant, Evaluation, Results, Tournament, Training, run
from envs import Hill

DRIVERS = ["compiled", "pettingzoo"]
NEAR = Hill(
    goal_position=-0.35, max_position=0.5
)  # thrust right reaches it from a start far to the left only


GREEDY: dict[str, Any] = {"bins": 1, "step_size": 0.5, "discount": 1.0, "epsilon": 0.0}


def raced(driver: str, cls: type[Any], steps: int, hill: Hill | None = None, **parameters: Any) -> Results:
    """One run of six episodes of so many steps at most; of one episode where no hill is given."""
    tournament = Tournament(
        (Entrant("it", cls, **parameters),),
        hill or Hill(),
        Training(6 if hill else 1, steps),
        Evaluation(1, 1),
        replicates=1,
    )
    return run(tournament, n_jobs=1, driver=driver)


@pytest.mark.parametrize("driver", DRIVERS)
def test_q_learning_step_by_step(driver: str) -> None:
    # One cell, all values 0, step size 1/2, no discount, always greedy, the lowest of equal actions:
    #   S&B 6.5: choose A; take it; Q(A) += 1/2 (-1 + max Q - Q(A)); choose again, from the new values.
    #   A = 0: Q = (-1/2, 0, 0).  A = 1: (-1/2, -1/2, 0).  A = 2: (-1/2, -1/2, -1/2).
    #   A = 0: -1/2 + 1/2 (-1 - 1/2 + 1/2) = -1.  A = 1: -1/2 + 1/2 (-1) = -1.
    values = [(-0.5, 0, 0), (-0.5, -0.5, 0), (-0.5, -0.5, -0.5), (-1, -0.5, -0.5), (-1, -1, -0.5)]
    visits = [(1, 0, 0), (1, 1, 0), (1, 1, 1), (2, 1, 1), (2, 2, 1)]
    for steps, (q, n) in enumerate(zip(values, visits, strict=True), 1):
        with raced(driver, QLearning, steps, **GREEDY) as results:
            assert results.arrays("it")["values"].tolist() == [list(q)]
            assert results.arrays("it")["visits"].tolist() == [list(n)]


@pytest.mark.parametrize("driver", DRIVERS)
def test_sarsa_step_by_step(driver: str) -> None:
    # The same, by S&B 6.4: choose A; take it; choose A' from the values before the update;
    # Q(A) += 1/2 (-1 + Q(A') - Q(A)); A' is what is done, whatever the update made of it.
    #   A = 0, A' = 0: (-1/2, 0, 0).  A = 0, A' = 1: -1/2 + 1/2 (-1 + 0 + 1/2) = -3/4.
    #   A = 1, A' = 1: (-3/4, -1/2, 0).  A = 1, A' = 2: -1/2 + 1/2 (-1 + 0 + 1/2) = -3/4.
    #   A = 2, A' = 2: (-3/4, -3/4, -1/2).
    values = [(-0.5, 0, 0), (-0.75, 0, 0), (-0.75, -0.5, 0), (-0.75, -0.75, 0), (-0.75, -0.75, -0.5)]
    visits = [(1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 2, 0), (2, 2, 1)]
    for steps, (q, n) in enumerate(zip(values, visits, strict=True), 1):
        with raced(driver, Sarsa, steps, **GREEDY) as results:
            assert results.arrays("it")["values"].tolist() == [list(q)]
            assert results.arrays("it")["visits"].tolist() == [list(n)]


class Diary(NamedTuple):
    """Counts its calls, and learns that act follows learn, or the other way round."""

    calls: NDArray[np.int64]  # of act; of learn; of act since the last learn; most of these

    @classmethod
    def create(cls, task: Any) -> Self:
        return cls(np.zeros(4, np.int64))

    def act(self, observation: Any, progress: float, rng: np.random.Generator) -> int:
        self.calls[0] += 1
        self.calls[2] += 1
        self.calls[3] = max(self.calls[3], self.calls[2])
        return 2

    def note(self) -> None:
        self.calls[1] += 1
        self.calls[2] = 0

    def greedy(self, observation: Any) -> int:
        return 1


class Before(Diary):
    __slots__ = ()

    def learn(self, observation, action, reward, next_observation, next_action, terminated):  # type: ignore[no-untyped-def]
        self.note()


class Unnamed(Diary):
    """Of the time when all agents were told the next action, whatever they called it."""

    __slots__ = ()

    def learn(self, s, a, r, s2, a2, end):  # type: ignore[no-untyped-def]
        self.note()


class After(Diary):
    __slots__ = ()

    def learn(self, observation, action, reward, next_observation, terminated):  # type: ignore[no-untyped-def]
        self.note()


class AnyNumber:
    """Not compiled: told everything."""

    def __init__(self) -> None:
        self.calls = np.zeros(4, np.int64)

    act: Any = Diary.act
    note: Any = Diary.note
    greedy: Any = Diary.greedy

    def learn(self, *step: Any) -> None:
        assert len(step) == 6
        self.note()


class AfterWithMore(AnyNumber):
    def learn(
        self,
        observation: Any,
        action: Any,
        reward: Any,
        next_observation: Any,
        terminated: Any,
        more: str = "no",
    ) -> None:
        assert (type(terminated), more) in {(bool, "no"), (np.bool_, "no")}
        self.note()


@pytest.mark.parametrize("driver", DRIVERS)
@pytest.mark.parametrize(
    ("cls", "before"),
    [(Before, True), (Unnamed, True), (After, False), (AnyNumber, True), (AfterWithMore, False)],
)
def test_the_next_action_is_drawn_before_the_update_or_after_it_where_a_step_follows(
    cls: type[Any], before: bool, driver: str
) -> None:
    if driver == "compiled" and not hasattr(cls, "_fields"):
        driver = "auto"
    with raced(driver, cls, 40, NEAR) as results:
        arrays = results.arrays("it")
    lengths, calls = arrays["lengths"], arrays["calls"]
    assert min(lengths) < 40 == max(lengths)  # some reached the goal, some did not
    episodes, steps = len(lengths), lengths.sum()
    assert calls[1] == steps
    assert calls[0] == steps + (episodes if before else 0)
    assert calls[3] == (2 if before else 1)
    assert learns_with_next_action(cls.create(NEAR) if hasattr(cls, "create") else cls()) == before


BEFORE = {
    "sarsa": "S&B 6.4",
    "n-step-sarsa": "7.2",
    "semi-gradient-sarsa": "10.2",
    "sarsa-lambda": "12.7",
    "true-online-sarsa": "12.7",
    "watkins-q-lambda": "S&B 1998, Figure 7.14: whether the next action is greedy cuts the traces",
    "monte-carlo": "5.4: the policy is the same for an episode",
}
AFTER = {
    "q-learning": "S&B 6.5",
    "tutorial": "the tutorial's program",
    "expected-sarsa": "6.6",
    "double-q-learning": "6.7",
    "dyna-q": "8.2",
    "prioritized-sweeping": "8.4",
    "r-max": "Brafman & Tennenholtz 2002, Figure 1",
    "fitted-q-iteration": "Ernst et al. 2005: a batch",
}


def test_each_agent_has_the_order_of_its_source() -> None:
    learners = {name: cls for name, cls in BUILT_IN.items() if not issubclass(cls, DoesNotLearn)}
    assert learners.keys() == BEFORE.keys() | AFTER.keys()
    for name, cls in learners.items():
        assert learns_with_next_action(cls.create(NEAR)) == (name in BEFORE), name

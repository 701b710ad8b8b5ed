"""The checks of the contract: what every agent must hold to. ``arena.testing`` runs them."""

import itertools
import random
import tempfile
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from arena.execution import compiled_driver, pettingzoo_driver
from arena.execution.checkpoint import checkpoint_of, savable
from arena.execution.loops import episode_hook, learner_and_actor
from arena.tournament.conditions import Conditions, Evaluation, Run, Training
from arena.tournament.entrant import Entrant
from arena.tournament.outcome import Outcome, agent_arrays
from envs import Hill
from envs.compilation.kernels import CompilationError
from envs.foundation.streams import stream

_HILL = Hill()
_CONDITIONS = Conditions(
    _HILL, Training(episodes=12, max_steps=150), Evaluation(episodes=5, max_steps=150), 7
)
_HOSTILE = 1000


class NotApplicableError(Exception):
    """The check does not apply to this agent; the message says why."""


Check = Callable[[Entrant], None]


def check_same_seed_same_bits(entrant: Entrant) -> None:
    """Two runs with the same seed do the same and leave the same bits, whatever happened between them."""
    actions, first = _actions(entrant), _race(entrant)
    _race(entrant, seed=8)  # a trace left in the class, or anywhere, would show in the next
    _same(first, _race(entrant), "a second run with the same seed")
    _hold(actions == _actions(entrant), "a second run with the same seed chooses other actions")


def check_compiled_is_interpreted(entrant: Entrant) -> None:
    """The compiled and the interpreted run leave the same bits."""
    run = Run(entrant, 0)
    if not hasattr(entrant.agent, "_fields"):
        raise NotApplicableError("it is no NamedTuple, so it runs interpreted")
    try:
        compiled_driver.prepare(_CONDITIONS, run, _create(entrant))
    except CompilationError as error:
        raise NotApplicableError(f"it runs interpreted: {error}") from None
    (compiled,) = compiled_driver.drive(_CONDITIONS, [run])
    _same(_finished(compiled), _race(entrant), "the compiled run")


def check_independent_of_others(entrant: Entrant) -> None:
    """Neither another entrant beside it nor the global random numbers change its bits, or are changed."""
    alone = _race(entrant)
    other = Entrant(f"{entrant.name} beside it", entrant.agent, **entrant.parameters)
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002 (agents must not use it)
    state, legacy = random.getstate(), np.random.get_state()[1].copy()  # type: ignore[index] # noqa: NPY002 (a tuple; see above)
    together = pettingzoo_driver.drive(_CONDITIONS, [Run(other, 0), Run(entrant, 0)])[1]
    _same(alone, together, "a run beside another entrant, with other global random numbers,")
    unused = random.getstate() == state and np.array_equal(np.random.get_state()[1], legacy)  # type: ignore[index] # noqa: NPY002 (a tuple; see above)
    _hold(unused, "it draws from the global random numbers; all must come from the rng that it is given")


def check_travels(entrant: Entrant) -> None:
    """The entrant can be sent to a worker, and leaves the same bits from there."""
    import cloudpickle

    _same(_race(entrant), _race(cloudpickle.loads(cloudpickle.dumps(entrant))), "a run of its copy")


def check_saves_and_loads(entrant: Entrant) -> None:
    """A checkpoint restores the same greedy policy."""
    agent = _trained(entrant)
    if not savable(agent):
        raise NotApplicableError("it cannot be saved in the middle: an interrupted run starts anew")
    with tempfile.TemporaryDirectory() as folder:
        conditions = Conditions(_HILL, _CONDITIONS.training, _CONDITIONS.evaluation, 7, folder)
        checkpoint_of(conditions, Run(entrant, 0), agent).save(1)
        restored = _create(entrant)
        checkpoint_of(conditions, Run(entrant, 0), restored).restore()
    for observation in _observations():
        _hold(
            agent.greedy(observation) == restored.greedy(observation),
            f"greedy({observation}) differs after saving and loading",
        )


def check_evaluation_does_not_learn(entrant: Entrant) -> None:
    """``greedy`` changes no array of the agent."""
    agent = _trained(entrant)
    before = {name: array.tobytes() for name, array in agent_arrays(agent).items()}
    for observation in _observations():
        agent.greedy(observation)
    for name, array in agent_arrays(agent).items():
        _hold(array.tobytes() == before[name], f"greedy changes {name}; it must not learn")


def check_actions_are_valid(entrant: Entrant) -> None:
    """``act`` and ``greedy`` choose actions that there are, in the whole box and at its corners."""
    rng = np.random.default_rng(3)
    for make in (_create, _trained):
        agent = make(entrant)
        for observation in _observations():
            for progress in (0.0, 0.5, 1.0 - 1e-9):
                _valid(agent.act(observation, progress, rng), f"act({observation})")
            _valid(agent.greedy(observation), f"greedy({observation})")


def check_survives_hostile_transitions(entrant: Entrant) -> None:
    """1,000 transitions that no hill makes leave no NaN, index no array beyond its end, and raise nothing."""
    agent, rng = _create(entrant), np.random.default_rng(4)
    places = list(_observations())
    hook = episode_hook(agent)
    hook.begin_episode()

    def act(observation: Any) -> int:
        return _valid(agent.act(observation, rng.random(), rng), f"act({observation})")

    learn_and_act = learner_and_actor(agent, act)
    for _ in range(_HOSTILE):
        here, there = (places[rng.integers(len(places))] for _ in range(2))
        action = act(here)
        ended = bool(rng.random() < 0.05)
        learn_and_act((here, action, -1.0, there), ended, ended)
        if ended or rng.random() < 0.02:
            hook.begin_episode()
    for name, array in agent_arrays(agent).items():
        if np.issubdtype(array.dtype, np.inexact):
            _hold(not np.isnan(array).any(), f"{name} has NaN after hostile transitions")
    for observation in places:
        _valid(agent.greedy(observation), f"greedy({observation})")


CHECKS: tuple[Check, ...] = (
    check_same_seed_same_bits,  # first: what is shared may fill up in the others and change no more
    check_actions_are_valid,
    check_survives_hostile_transitions,
    check_evaluation_does_not_learn,
    check_independent_of_others,
    check_travels,
    check_saves_and_loads,
    check_compiled_is_interpreted,
)


def _race(entrant: Entrant, seed: int = 7) -> Outcome:
    conditions = Conditions(_HILL, _CONDITIONS.training, _CONDITIONS.evaluation, seed)
    (outcome,) = pettingzoo_driver.drive(conditions, [Run(entrant, 0)])
    return _finished(outcome)


def _same(first: Outcome, second: Outcome, what: str) -> None:
    _hold(first.arrays == _finished(second).arrays, f"{what} leaves other bits")


def _finished(outcome: Outcome) -> Outcome:
    if outcome.error:
        raise AssertionError(outcome.error.strip().splitlines()[-1])
    return outcome


def _create(entrant: Entrant, seed: int = 7) -> Any:
    return entrant.create(_HILL, stream(seed, "create", entrant.name))


def _trained(entrant: Entrant) -> Any:
    """An agent after a few hundred steps."""
    return _drive(entrant)[0]


def _actions(entrant: Entrant) -> list[int]:
    """What it does in a few hundred steps, and would do there afterwards: not all of it leaves bits."""
    agent, steps = _drive(entrant)
    return [action for _, action in steps] + [agent.greedy(observation) for observation, _ in steps]


def _drive(entrant: Entrant) -> tuple[Any, list[tuple[Any, int]]]:
    """An agent after a few hundred steps, with what it saw and did."""
    agent, rng, steps = _create(entrant), np.random.default_rng(5), []

    def act(observation: Any) -> int:
        return int(agent.act(observation, 0.5, rng))

    learn_and_act = learner_and_actor(agent, act)
    for _ in range(3):
        state = _HILL.reset(rng)
        episode_hook(agent).begin_episode()
        action = act(np.array(_HILL.observe(state)))
        for _ in range(150):
            before = np.array(_HILL.observe(state))
            state, reward, terminated = _HILL.step(state, action)
            after = np.array(_HILL.observe(state))
            steps.append((before, action))
            action = learn_and_act((before, action, reward, after), terminated, terminated)
            if terminated:
                break
    return agent, steps


def _observations() -> Iterator[Any]:
    """The corners of the observation box, its middle, and places in it at random."""
    low, high = np.array(_HILL.low), np.array(_HILL.high)
    yield from (
        np.array(corner) for corner in itertools.product(*zip(low, (low + high) / 2, high, strict=True))
    )
    yield from np.random.default_rng(6).uniform(low, high, (100, len(low)))


def _valid(action: Any, what: str) -> int:
    is_integer = isinstance(action, (int, np.integer)) and not isinstance(action, bool)
    _hold(is_integer, f"{what} must return an integer, got {action!r}")
    _hold(
        0 <= action < _HILL.n_actions,
        f"{what} must be less than {_HILL.n_actions} and not negative, got {action}",
    )
    return int(action)


def _hold(condition: Any, message: str) -> None:
    """``assert``, also where Python leaves assertions out."""
    if not condition:
        raise AssertionError(message)

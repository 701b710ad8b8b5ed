"""The agents by the names they have in files and on the command line.

Built-in ones, those that installed packages offer by an entry point of the group ``arena.agents``, and
those that this process registers.
"""

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from agents.algorithms.double_q_learning import DoubleQLearning
from agents.algorithms.dyna_q import DynaQ
from agents.algorithms.expected_sarsa import ExpectedSarsa
from agents.algorithms.fitted_q_iteration import FittedQIteration
from agents.algorithms.monte_carlo import MonteCarlo
from agents.algorithms.n_step_sarsa import NStepSarsa
from agents.algorithms.prioritized_sweeping import PrioritizedSweeping
from agents.algorithms.q_learning import QLearning
from agents.algorithms.r_max import RMax
from agents.algorithms.sarsa import Sarsa
from agents.algorithms.sarsa_lambda import SarsaLambda
from agents.algorithms.semi_gradient_sarsa import SemiGradientSarsa
from agents.algorithms.true_online_sarsa import TrueOnlineSarsa
from agents.algorithms.tutorial import TutorialQLearning
from agents.algorithms.value_iteration import ValueIteration
from agents.algorithms.watkins_q_lambda import WatkinsQLambda
from agents.baselines import MomentumAgent, RandomAgent, XiaoAgent
from agents.optimal.driver import Optimal
from envs.foundation.checks import choice
from envs.foundation.errors import InvalidTypeError, InvalidValueError

GROUP = "arena.agents"

BUILT_IN: dict[str, type[Any]] = {
    agent.name: agent
    for agent in (
        QLearning,
        Sarsa,
        ExpectedSarsa,
        DoubleQLearning,
        NStepSarsa,
        MonteCarlo,
        DynaQ,
        PrioritizedSweeping,
        RMax,
        SemiGradientSarsa,
        SarsaLambda,
        TrueOnlineSarsa,
        WatkinsQLambda,
        FittedQIteration,
        TutorialQLearning,
        XiaoAgent,
        RandomAgent,
        MomentumAgent,
        ValueIteration,
        Optimal,
    )
}

_EITHER = inspect.Parameter.POSITIONAL_OR_KEYWORD
_METHODS = {  # with the numbers of arguments that each may take
    "act": ("observation, progress, rng", (3,)),
    "learn": ("observation, action, reward, next_observation[, next_action], terminated", (6, 5)),
    "greedy": ("observation", (1,)),
}


@dataclass(frozen=True)
class Registered:
    """An agent under a name.

    Attributes:
        name: in files and on the command line.
        agent: the class.
        origin: where it comes from, in words.
    """

    name: str
    agent: type[Any]
    origin: str


class BrokenAgentError(InvalidValueError):
    """An agent of an installed package that cannot be used; the message is one sentence that says why."""


_registered: dict[str, Registered] = {}


def register(name: str, agent: type[Any], origin: str = "registered by a script") -> None:
    """Make ``agent`` known as ``name`` in this process; the same origin may do so again.

    Raises:
        TypeError: when the class lacks a method of the contract, or one has the wrong arguments.
        ValueError: when the name is taken.
    """
    check_methods(agent)
    taken = all_agents()[0].get(name)
    if taken and taken.origin != origin:
        raise InvalidValueError(f"agent {name!r} of {origin} has a name that is taken: {taken.origin}")
    _registered[name] = Registered(name, agent, origin)


def forget(origin: str) -> None:
    """Make unknown what ``origin`` has registered."""
    for name in [name for name, entry in _registered.items() if entry.origin == origin]:
        del _registered[name]


@contextmanager
def isolated() -> Iterator[None]:
    """Meanwhile it is as in a new process: nothing is registered, and installed packages are looked for anew.

    At the end what was registered before is known again, and what was registered meanwhile no more.
    """
    before = dict(_registered)
    _registered.clear()
    _installed.cache_clear()
    try:
        yield
    finally:
        _registered.clear()
        _registered.update(before)
        _installed.cache_clear()


def all_agents() -> tuple[dict[str, Registered], list[str]]:
    """All agents by name, and a line for each installed plugin that is broken."""
    installed, broken, taken = _installed()
    built_in = {name: Registered(name, agent, "built in") for name, agent in BUILT_IN.items()}
    return {**built_in, **installed, **_registered}, [*broken.values(), *taken]


def agent_class(name: str) -> type[Any]:
    """The class of the agent called ``name``.

    Raises:
        BrokenAgentError: a ValueError; when it is one of an installed package that is broken.
        ValueError: when there is none; the message lists those there are.
    """
    if isinstance(name, str) and name in BUILT_IN:  # spares loading the packages
        return BUILT_IN[name]
    known, broken = all_agents()[0], _installed()[1]
    if choice("agent", name, {*known, *broken}) not in known:
        raise BrokenAgentError(broken[name])
    return known[name].agent


def agent_name(cls: type[Any]) -> str:
    """The name of the class in files: the one it is registered by, else ``module:Class``."""
    for name, known in BUILT_IN.items():
        if known is cls:
            return name
    for entry in (*_registered.values(), *_installed()[0].values()):
        if entry.agent is cls:
            return entry.name
    return f"{cls.__module__}:{cls.__qualname__}"


def check_methods(agent: Any) -> None:
    """See that a class has the methods of ``agents.Agent``, with arguments as many as it says.

    Raises:
        TypeError: when it has not.
    """
    if not isinstance(agent, type):
        raise InvalidTypeError(f"agent must be a class, got {agent!r}")
    for method, (arguments, numbers) in _METHODS.items():
        function = getattr(agent, method, None)
        if not callable(function):
            raise InvalidTypeError(
                f"agent must have the methods {', '.join(_METHODS)}; {agent.__name__} lacks {method}"
            )
        if not any(_takes(function, number + 1) for number in numbers):
            raise InvalidTypeError(
                f"{agent.__name__}.{method} must take (self, {arguments}), got {inspect.signature(function)}"
            )
    if hasattr(agent, "create"):
        _check_create(agent)


def _takes(function: Callable[..., Any], number: int) -> bool:
    try:
        inspect.signature(function).bind(*range(number))
    except TypeError:
        return False
    except ValueError:  # not written in Python
        return True
    return True


def _check_create(agent: type[Any]) -> None:
    signature = inspect.signature(agent.create)
    kinds = [parameter.kind for parameter in signature.parameters.values()]
    positional = sum(kind in (inspect.Parameter.POSITIONAL_ONLY, _EITHER) for kind in kinds)
    if positional != 1 and inspect.Parameter.VAR_POSITIONAL not in kinds:
        raise InvalidTypeError(
            f"{agent.__name__}.create must be a class method that takes (cls, task, *, its parameters), "
            f"got {signature} without the class"
        )


@cache
def _installed() -> tuple[dict[str, Registered], dict[str, str], tuple[str, ...]]:
    """The agents of installed packages; a line for each that is broken; one for each whose name is taken."""
    usable: dict[str, Registered] = {}
    broken: dict[str, str] = {}
    clashes = []
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value)):
        origin = _origin(entry)
        try:
            agent = entry.load()
            check_methods(agent)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # whatever the package raises; sys.exit, too
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            broken[entry.name] = f"agent {entry.name!r} of {origin} is broken: {reason}"
            continue
        if entry.name in BUILT_IN or entry.name in usable:
            taken = usable[entry.name].origin if entry.name in usable else "built in"
            clashes.append(f"agent {entry.name!r} of {origin} has a name that is taken: {taken}")
            continue
        usable[entry.name] = Registered(entry.name, agent, origin)
    return usable, broken, tuple(clashes)


def _origin(entry: EntryPoint) -> str:
    return f"package {entry.dist.name} {entry.dist.version}" if entry.dist else f"module {entry.module}"

"""How long a step of an agent's learning takes, beside the built-in Q-learning's."""

import time

import numpy as np

from agents import QLearning
from arena.execution import pettingzoo_driver
from arena.execution.loops import train, training_loop
from arena.tournament.conditions import Conditions, Evaluation, Run, Training
from arena.tournament.entrant import Entrant
from envs import Hill
from envs.compilation.kernels import CompilationError, compile_loop

_EPISODES, _MAX_STEPS = 100, 1000


def seconds_per_step(entrant: Entrant, seconds: float = 0.5) -> tuple[float, float]:
    """How long a step of learning takes, and the same of the built-in Q-learning, right after it.

    Args:
        entrant: compiled if it can be; what compiling takes is not counted.
        seconds: how long each is measured at least.
    """
    return _measure(entrant, seconds), _measure(Entrant("q-learning", QLearning), seconds)


def _measure(entrant: Entrant, seconds: float) -> float:
    drive = _compiled if hasattr(entrant.agent, "_fields") else _interpreted
    took, steps = 0.0, 0
    try:
        drive(entrant)
    except CompilationError:
        drive = _interpreted
    while took < seconds:
        more_seconds, more_steps = drive(entrant)
        took, steps = took + more_seconds, steps + more_steps
    return took / steps


def _compiled(entrant: Entrant) -> tuple[float, int]:
    """Seconds and steps of a short training."""
    conditions = Conditions(Hill(), Training(_EPISODES, _MAX_STEPS), Evaluation(1, 1), 0)
    agent = entrant.create(conditions.hill, np.random.default_rng(0))
    loop = training_loop(conditions, Run(entrant, 0), agent)
    kernel = compile_loop(train, loop, 0, _EPISODES)
    began = time.perf_counter()
    kernel(loop, 0, _EPISODES)
    return time.perf_counter() - began, int(loop.lengths.sum())


def _interpreted(entrant: Entrant) -> tuple[float, int]:
    conditions = Conditions(Hill(), Training(5, _MAX_STEPS), Evaluation(1, 1), 0)
    began = time.perf_counter()
    (outcome,) = pettingzoo_driver.drive(conditions, [Run(entrant, 0)])
    return time.perf_counter() - began, outcome.iterations or 1

"""The compiled driver: training and evaluation fused with the hill and the agent into machine code.

To the bit the results of the PettingZoo driver.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from arena.execution.checkpoint import checkpoint_of
from arena.execution.loops import evaluate, listener, train
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome
from envs.compilation.kernels import compile_loop
from envs.compilation.reachable import Reached
from envs.foundation.streams import stream

NAME = "compiled"
_PIECE = 1000  # episodes at first between two looks at the clock
_SHORT = 0.5  # seconds; a shorter piece is doubled, a longer one halved


def race(conditions: Conditions, run: Run) -> Outcome:
    """Train and evaluate one car.

    Raises:
        envs.compilation.CompilationError: when the agent cannot be compiled.
        Exception: whatever the agent raises.
    """
    began = time.perf_counter()
    agent = run.entrant.create(conditions.hill, stream(conditions.seed, "create", run.identity))
    training, evaluation = _arguments(conditions, agent, run)
    _train(conditions, run, training)
    compile_loop(evaluate, *evaluation)(*evaluation)
    seconds = time.perf_counter() - began
    test_lengths, test_reached = evaluation[-2:]
    return Outcome.finished(run, NAME, agent, training[-1], test_lengths, test_reached, seconds)


def _train(conditions: Conditions, run: Run, arguments: tuple[Any, ...]) -> None:
    """Train in one go, or piece by piece with a checkpoint now and then."""
    kernel = compile_loop(train, *arguments)
    (hill, agent, listening, n_actions, done, episodes), rest = arguments[:6], arguments[6:]
    checkpoint = checkpoint_of(conditions, run, agent, *rest[2:])
    done = checkpoint.restore()
    piece = _PIECE if checkpoint.path else episodes
    saved = time.monotonic()
    while done < episodes:
        began, last = time.monotonic(), min(done + piece, episodes)
        kernel(hill, agent, listening, n_actions, done, last, *rest)
        now, done = time.monotonic(), last
        if now - saved >= conditions.checkpoint_seconds and done < episodes:
            checkpoint.save(done)
            saved = now
        piece = max(1, piece * 2 if now - began < _SHORT else piece // 2)


def prepare(conditions: Conditions, run: Run) -> None:
    """Compile what ``race`` runs, or load it from the cache on disk.

    Raises:
        envs.compilation.CompilationError: when the agent cannot be compiled.
    """
    for loop, arguments in _loops(conditions, run):
        compile_loop(loop, *arguments)


def fingerprint(conditions: Conditions, run: Run) -> str:
    """The same for two runs if the same machine code drives both."""
    return " ".join(Reached(loop, *arguments).fingerprint() for loop, arguments in _loops(conditions, run))


def _loops(conditions: Conditions, run: Run) -> list[tuple[Callable[..., Any], tuple[Any, ...]]]:
    agent = run.entrant.create(conditions.hill, np.random.default_rng(0))
    training, evaluation = _arguments(conditions, agent, run)
    return [(train, training), (evaluate, evaluation)]


def _arguments(conditions: Conditions, agent: Any, run: Run) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The arguments of the two loops; the arrays that they fill come last."""
    hill, training, evaluation = conditions.hill, conditions.training, conditions.evaluation
    return (
        hill,
        agent,
        listener(agent),
        hill.n_actions,
        0,
        training.episodes,
        training.episodes,
        training.max_steps,
        stream(conditions.seed, "start", run.identity),
        stream(conditions.seed, "act", run.identity),
        np.zeros(training.episodes, np.int64),
    ), (
        hill,
        agent,
        hill.n_actions,
        conditions.start_states(run.replicate),
        evaluation.max_steps,
        np.zeros(evaluation.episodes, np.int64),
        np.zeros(evaluation.episodes, np.bool_),
    )

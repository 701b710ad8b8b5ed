"""The compiled driver: training and evaluation fused with the hill and the agent into machine code.

To the bit the results of the PettingZoo driver.
"""

import time
import traceback
from collections.abc import Iterable
from typing import Any

import numpy as np

from arena.execution.checkpoint import checkpoint_of
from arena.execution.loops import TrainingLoop, evaluate, evaluation_loop, train, training_loop
from arena.tournament.conditions import Conditions, Run
from arena.tournament.outcome import Outcome
from envs.compilation.kernels import compile_loop, kernel_info
from envs.compilation.reachable import ReachableCode

NAME = "compiled"
_PIECE = 1000  # episodes at first between two looks at the clock
_SHORT = 0.5  # seconds, or the time between two checkpoints; a shorter piece is doubled, a longer one halved


def drive(conditions: Conditions, runs: Iterable[Run]) -> list[Outcome]:
    """Train and evaluate the cars of ``runs``, one after the other; one whose agent raises has failed."""
    outcomes = []
    for run in runs:
        try:
            outcomes.append(_drive(conditions, run))
        except KeyboardInterrupt:
            raise
        except BaseException:  # sys.exit, too
            outcomes.append(Outcome.failure(run, NAME, traceback.format_exc()))
    return outcomes


def prepare(conditions: Conditions, run: Run, agent: Any) -> None:
    """Compile what ``drive`` runs, or load it from the cache on disk.

    Raises:
        envs.compilation.CompilationError: when the agent cannot be compiled.
    """
    kernel_info(train, training_loop(conditions, run, agent), 0, 0)
    kernel_info(evaluate, evaluation_loop(conditions, run, agent))


def fingerprint(conditions: Conditions, run: Run, agent: Any) -> str:
    """The same for two runs if the same machine code drives both."""
    loops = (
        ReachableCode(train, training_loop(conditions, run, agent), 0, 0),
        ReachableCode(evaluate, evaluation_loop(conditions, run, agent)),
    )
    return " ".join(reached.fingerprint() for reached in loops)


def untrained(conditions: Conditions, run: Run) -> Any:
    """An agent of the run's entrant to look at, not to drive."""
    return run.entrant.create(conditions.hill, np.random.default_rng(0))


def _drive(conditions: Conditions, run: Run) -> Outcome:
    began = time.perf_counter()
    agent = run.entrant.create(conditions.hill, run.stream(conditions.seed, "create"))
    training, evaluation = training_loop(conditions, run, agent), evaluation_loop(conditions, run, agent)
    _train(conditions, run, training)
    compile_loop(evaluate, evaluation)(evaluation)
    seconds = time.perf_counter() - began
    return Outcome.finished(
        run, NAME, agent, training.lengths, evaluation.lengths, evaluation.reached, seconds
    )


def _train(conditions: Conditions, run: Run, loop: TrainingLoop) -> None:
    """Train in one go, or piece by piece with a checkpoint now and then."""
    kernel = compile_loop(train, loop, 0, 0)
    checkpoint = checkpoint_of(conditions, run, loop.agent, loop.start_rng, loop.action_rng, loop.lengths)
    done = checkpoint.restore()
    short = min(_SHORT, conditions.checkpoint_seconds)
    piece = (_PIECE if short else 1) if checkpoint.path else loop.episodes
    saved = time.monotonic()
    while done < loop.episodes:
        began, last = time.monotonic(), min(done + piece, loop.episodes)
        kernel(loop, done, last)
        now, done = time.monotonic(), last
        if now - saved >= conditions.checkpoint_seconds and done < loop.episodes:
            checkpoint.save(done)
            saved = now
        piece = max(1, piece * 2 if now - began < short else piece // 2)

"""Every way to fail is a result, and nobody else notices."""

import time
from dataclasses import replace
from pathlib import Path

import failing_agents as failing
import joblib
import pytest
from bits import bits_of

from agents import QLearning, Sarsa
from arena import Entrant, Evaluation, Tournament, Training, run

HEALTHY = (
    Entrant("q", QLearning, bins=(5, 6)),
    Entrant("s", Sarsa, bins=(6, 5)),
    Entrant("h", failing.Healthy),
)
REASONS = {
    failing.Raises: "RuntimeError: learned too much",
    failing.RaisesInGreedy: "KeyError: 'no policy'",
    failing.RaisesWhenMade: "RuntimeError: never made",
    failing.RaisesAtEpisode: "RuntimeError: no episodes",
    failing.ActsBeyond: "ValueError: action must be less than 3, got 3",
    failing.ActsNan: "TypeError: action must be an integer, got nan",
    failing.ActsText: "TypeError: action must be an integer, got 'left'",
    failing.TurnsNan: "ValueError: table must be free of NaN after training, got 1 of them",
    failing.Exits: "SystemExit: enough",
    failing.ExitsAtOnce: "the worker died: exit code EXIT(3)",
    failing.Crashes: "the worker died: exit code SIGSEGV(-11)",
    failing.IsKilled: "the worker died: exit code SIGKILL(-9)",
    failing.Hangs: "the worker died: the time limit of 4 s is over",
    failing.HangsWithTheInterpreter: "the worker died: the time limit of 4 s is over",
    failing.EatsMemory: "the worker died: the memory limit of 1000 MiB is broken",
    failing.CannotTravel: "it cannot be sent to a worker: TypeError",
    failing.HangsCompiled: "the worker died: the time limit of 4 s is over",
}


def tournament(*entrants: Entrant) -> Tournament:
    return Tournament(
        entrants,
        training=Training(episodes=6, max_steps=120),
        evaluation=Evaluation(episodes=5, max_steps=150),
        replicates=1,
        seed=7,
        time_limit=4.0,
        memory_limit=1000.0,
    )


@pytest.mark.system
def test_every_kind_of_failure_is_told_and_the_healthy_are_as_without_it(tmp_path: Path) -> None:
    with run(tournament(*HEALTHY), n_jobs=2) as results:
        expected = bits_of(results)[1]
    bad = [Entrant(kind.__name__, kind) for kind in REASONS]
    began = time.monotonic()
    with run(tournament(*bad[:8], *HEALTHY, *bad[8:]), tmp_path / "r.sqlite", n_jobs=2) as results:
        runs = {one["entrant"]: one for one in results.runs}
        found = bits_of(results)[1]
    assert time.monotonic() - began < 150.0
    assert {key: found[key] for key in expected} == expected
    reasons = {kind.__name__: runs[kind.__name__]["error"].strip().splitlines()[-1] for kind in REASONS}
    for kind, reason in REASONS.items():
        assert runs[kind.__name__]["status"] == "failed"
        assert reason in reasons[kind.__name__]


@pytest.mark.system
@pytest.mark.parametrize("kind", [failing.ExitsAtOnce, failing.Hangs])
def test_a_lost_worker_is_told_with_one_job_too_where_there_are_limits(kind: type) -> None:
    limited = replace(tournament(Entrant("bad", kind), HEALTHY[0]), time_limit=3.0)
    with run(limited, n_jobs=1) as results:
        statuses = {one["entrant"]: one["status"] for one in results.runs}
    assert statuses == {"bad": "failed", "q": "finished"}


def test_limits_need_worker_processes() -> None:
    with (
        joblib.parallel_config(backend="threading"),
        pytest.raises(ValueError, match="time_limit and memory_limit must be enforced in worker processes"),
    ):
        run(tournament(*HEALTHY))


@pytest.mark.parametrize("limit", [0, -1.0, float("nan"), "1 s"])
def test_a_bad_limit_is_told(limit: object) -> None:
    with pytest.raises((TypeError, ValueError), match="time_limit must be a"):
        Tournament(HEALTHY, time_limit=limit)  # type: ignore[arg-type]


def test_limits_may_change_when_a_tournament_is_continued(tmp_path: Path) -> None:
    limited = tournament(HEALTHY[0])
    run(limited, tmp_path / "r.sqlite", n_jobs=2).close()
    with run(replace(limited, time_limit=None), tmp_path / "r.sqlite", n_jobs=1) as results:
        assert len(results.runs) == 1

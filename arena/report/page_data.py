"""What the script of the page draws, as plain values: curves, maps, drives, pairs."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from agents.optimal.driver import Optimal
from arena.analysis.curves import WINDOW, reward_curves
from arena.analysis.policy_map import map_of, policy, visits
from arena.analysis.scores import Scores, improvement
from arena.analysis.standings import Leaderboard
from arena.results.results import Results
from arena.results.trained import Trained, UnknownPolicyError, drive
from arena.statistics.permutation import is_significant
from envs.foundation.errors import InvalidValueError

STARTS = 5  # of the race, evenly over the range of starts
_POINTS = 120  # of a curve
_THOUSANDTHS = 1000  # positions of the race are whole thousandths


def page_data(
    results: Results, scores: Scores, board: Leaderboard, most_drawn: int, replicate: int = 0
) -> dict[str, Any]:
    """The data, and under ``unavailable`` the entrants whose policies cannot be made again, with the reasons.

    Args:
        results: of the tournament.
        scores: of all entrants.
        board: by one of them.
        most_drawn: entrants with curves, maps and drives, the first ones by place.
        replicate: whose policies are drawn.
    """
    conditions = results.conditions
    hill = conditions.hill
    names = [standing.entrant for standing in board.standings]
    starts = np.linspace(hill.min_start, hill.max_start, STARTS).tolist()
    drawn, unavailable = [], []
    at = _sampled(conditions.training.episodes)
    for number, name in enumerate(names[:most_drawn]):
        try:
            policy_data = _policy(results.trained(name, replicate), starts)
        except InvalidValueError as error:  # not run yet, failed, or not to be made again
            policy_data = {"map": None, "drives": None}
            unavailable.append((name, str(error)))
        drawn.append({"entrant": number, "curve": _curve(results, name, at), **policy_data})
    order = [scores.entrants.index(name) for name in names]
    better = 100.0 * improvement(scores, board.by)[np.ix_(order, order)] if scores.replicates else None
    apart = is_significant(np.array(board.p_values), 1.0 - board.confidence)
    return {
        "names": names,
        "apart": ["".join("01"[int(pair)] for pair in row) for row in apart],
        "better": np.full(apart.shape, 50).tolist() if better is None else _whole(better),
        "episodes": conditions.training.episodes,
        "at": at,
        "drawn": drawn,
        "starts": starts,
        "hill": {
            "omega": hill.omega,
            "low": hill.min_position,
            "high": hill.max_position,
            "goal": hill.goal_position,
        },
        "ghost": _ghost(results, starts),
        "unavailable": unavailable,
    }


def _sampled(episodes: int) -> list[int]:
    """At which episodes the curves are told, at most ``_POINTS``; none if there is no curve."""
    if episodes < WINDOW:
        return []
    count = min(_POINTS, episodes - WINDOW + 1)
    return [int(episode) for episode in np.linspace(WINDOW, episodes, count).round()]


def _curve(results: Results, name: str, at: Sequence[int]) -> dict[str, Any] | None:
    try:
        curves = reward_curves(results, name)[:, np.array(at) - WINDOW]
    except InvalidValueError:  # no finished run, or too few episodes
        return None
    return {
        kind: _whole(rewards)
        for kind, rewards in (
            ("mean", curves.mean(axis=0)),
            ("low", curves.min(axis=0)),
            ("high", curves.max(axis=0)),
        )
    }


def _policy(agent: Trained, starts: Sequence[float]) -> dict[str, Any]:
    """The map and the drives of one entrant."""
    where = map_of(agent)
    counts = visits(agent, where)
    try:
        actions = "".join(map(str, policy(agent, where).ravel().tolist()))
    except UnknownPolicyError:
        actions = None
    return {
        "map": {
            "x": where.positions.round(5).tolist(),
            "v": where.velocities.round(6).tolist(),
            "policy": actions,
            "visits": None if counts is None else counts.ravel().tolist(),
        },
        "drives": [_whole(_THOUSANDTHS * agent.drive(start)[:, 0]) for start in starts],
    }


def _ghost(results: Results, starts: Sequence[float]) -> list[Any] | None:
    """Positions of the optimal drives; None on a hill for which there is no such driver."""
    conditions = results.conditions
    try:
        optimal = Optimal.create(conditions.hill)
    except InvalidValueError:
        return None
    limit = conditions.evaluation.max_steps
    paths = [drive(conditions.hill, optimal, start, limit) for start in starts]
    return [_whole(_THOUSANDTHS * path[:, 0]) for path in paths]


def _whole(values: ArrayLike) -> Any:
    return np.rint(values).astype(int).tolist()

"""What results mean: scores, regret, standings, comparisons, curves, policy maps."""

from arena.analysis.curves import area, learning_curves, moving_average, reward_curves, settled
from arena.analysis.pairwise import compare_entrants, regressions
from arena.analysis.policy_map import map_of
from arena.analysis.regret import fewest_steps
from arena.analysis.scores import SCORES, Scores, improvement, scores_of
from arena.analysis.standings import Leaderboard, Standing, leaderboard

__all__ = [
    "SCORES",
    "Leaderboard",
    "Scores",
    "Standing",
    "area",
    "compare_entrants",
    "fewest_steps",
    "improvement",
    "leaderboard",
    "learning_curves",
    "map_of",
    "moving_average",
    "regressions",
    "reward_curves",
    "scores_of",
    "settled",
]

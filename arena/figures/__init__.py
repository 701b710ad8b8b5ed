"""Results as pictures, on axes of Matplotlib or of its own making."""

from arena.figures.film import race, save_race
from arena.figures.learning import draw_learning
from arena.figures.policy import draw_phase, draw_policy, draw_value, draw_visits
from arena.figures.scores import draw_intervals, draw_pairs, draw_ranks, draw_regret
from arena.figures.sweep import draw_sweep
from arena.figures.walks import draw_hill, draw_lengths

__all__ = [
    "draw_hill",
    "draw_intervals",
    "draw_learning",
    "draw_lengths",
    "draw_pairs",
    "draw_phase",
    "draw_policy",
    "draw_ranks",
    "draw_regret",
    "draw_sweep",
    "draw_value",
    "draw_visits",
    "race",
    "save_race",
]

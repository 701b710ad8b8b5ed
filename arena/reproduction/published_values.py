"""The numbers that the paper prints."""

import csv
import math
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from arena.tournament.conditions import Training

Key = tuple[str, int, int]
MINIMUM_ACCURACY = 73.0  # "all the 32 algorithm runs produced an accuracy higher than 73%"


@lru_cache
def published() -> dict[Key, tuple[float, float, float]]:
    """Accuracy in percent, mean length and iterations, by algorithm, n_p and n_v."""
    first, second = (_table(f"table{number}.csv") for number in (1, 2))
    return {
        key: (
            float(row["accuracy_percent"]),
            float(row["mean_length"]),
            float(second[key]["iterations"]),
        )
        for key, row in first.items()
    }


def _table(name: str) -> dict[Key, dict[str, str]]:
    text = resources.files("arena.reproduction").joinpath("data", name).read_text(encoding="utf-8")
    return {
        (row["algorithm"], int(row["position_bins"]), int(row["velocity_bins"])): row
        for row in csv.DictReader(text.splitlines())
    }


REASONABLE = Training.max_steps
"""Steps of an episode that the paper calls reasonable (section 4.3); its limit N_LE."""


@dataclass(frozen=True)
class Summary:
    """The numbers that the paper gives of its walks.

    Attributes:
        episodes: how many.
        least: steps of the shortest episode.
        most: steps of the longest.
        mean: of the steps.
        deviation: standard deviation of the steps.
        position: least and greatest, in units of length.
        velocity: least and greatest, in units of length per unit of time.
        share_below: of the episodes of less than ``REASONABLE`` steps; the paper says only that it is
            more than a half.
        given_up: episodes that ended at the limit, not at the goal.
    """

    episodes: int
    least: int
    most: int
    mean: float
    deviation: float
    position: tuple[float, float]
    velocity: tuple[float, float]
    share_below: float = math.nan
    given_up: int = 0

    @property
    def standard_error(self) -> float:
        """Of the mean."""
        return self.deviation / math.sqrt(self.episodes)


PAPER = Summary(
    2000, 865, 324776, 42209.101, 37989.213, (-1.2, 0.52564615), (-0.06587993, 0.05977063), given_up=0
)
"""What the paper reports (section 3.2)."""

PAPER_SECONDS = 1057.793
"""What its walks took (section 3.2)."""

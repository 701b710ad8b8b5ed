"""Two cars that end at different times."""

from typing import Any

from pettingzoo.utils import BaseParallelWrapper


class Apart(BaseParallelWrapper):  # type: ignore[misc]  # the base is untyped
    """``car_0`` starts before the goal and ends at once, ``car_1`` drives until it is truncated."""

    def reset(self, seed: int | None = None, options: Any = None) -> Any:
        return self.env.reset(seed, {"start": {"car_0": (0.49, 0.05)}})

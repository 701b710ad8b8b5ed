"""Where a car starts, as the options of ``reset`` say."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from envs.foundation.checks import number
from envs.foundation.errors import InvalidValueError
from envs.hill import Hill, State


def checked_state(hill: Hill, state: Any, of: str = "") -> State:
    """A state that a car can be put at.

    Args:
        hill: where.
        state: position, the goal's at most, and velocity, within the hill's bounds.
        of: whose, for the message, such as ``" of car_0"``.

    Raises:
        TypeError, ValueError: when it is no such state.
    """
    if not isinstance(state, Iterable) or len(pair := tuple(state)) != 2:
        raise InvalidValueError(f"start{of} must be (position, velocity), got {state!r}")
    position, velocity = pair
    return (
        number(f"start position{of}", position, hill.min_position, hill.goal_position),
        number(f"start velocity{of}", velocity, hill.min_velocity, hill.max_velocity),
    )


def start_state(hill: Hill, rng: np.random.Generator, options: Mapping[str, Any] | None) -> State:
    """The start of one car.

    Args:
        hill: where.
        rng: draws one number, unless the start is given.
        options: ``start``, a state; or ``low`` and ``high`` of a position at rest.

    Raises:
        TypeError, ValueError: when an option breaks its rule.
    """
    if not options:
        return hill.reset(rng)
    if "start" in options:
        return checked_state(hill, options["start"])
    low = number("low", options.get("low", hill.min_start), hill.min_position, hill.goal_position)
    high = number("high", options.get("high", hill.max_start), low, hill.goal_position)
    return hill._replace(min_start=low, max_start=high).reset(rng)

"""The ring of steps that wait."""

import pytest

from agents import Grid
from agents.discretization import TileCoding
from agents.learning.step_buffer import StepBuffer


def fill(steps: StepBuffer, features: object, count: int) -> None:
    """Steps 0, 1, ... from k + 0.5 to k + 1.5, with action k % 3 and reward -k."""
    for k in range(count):
        steps.append(features, (k + 0.5,), k % 3, -float(k), (k + 1.5,), (k + 1) % 3)


@pytest.mark.parametrize("capacity", [1, 2, 3, 5])
@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 9])
def test_the_latest_steps_are_kept_and_the_step_to_come_is_known(capacity: int, count: int) -> None:
    steps, cells = StepBuffer.with_capacity(capacity), Grid((0.0,), (10.0,), 10)
    fill(steps, cells, count)
    assert steps.pending[0] == min(count, capacity)
    assert steps.is_full() == (count >= capacity)
    for age in range(1, steps.pending[0] + 1):
        place, k = steps.back(age), count - age
        assert (steps.states[place, 0], steps.actions[place], steps.rewards[place]) == (k, k % 3, -k)
    if count:
        here = steps.cursor[0]
        assert (steps.states[here, 0], steps.actions[here]) == (count, count % 3)


def test_all_active_features_are_kept() -> None:
    tiles = TileCoding((0.0,), (8.0,), 4, 4)
    steps = StepBuffer.with_capacity(2, tiles.active)
    fill(steps, tiles, 5)
    for age, at in ((0, 5.5), (1, 4.5), (2, 3.5)):
        active = steps.states[steps.back(age)] * 0
        tiles.fill((at,), active)
        assert steps.states[steps.back(age)].tolist() == active.tolist()

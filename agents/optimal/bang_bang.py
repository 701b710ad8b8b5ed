"""Drives of full thrust that change its direction a few times: all patterns of switches, and the best one."""

from agents.contract import Floats, Integers
from agents.optimal.relaxed_car import MAX_SWITCHES, Spacing
from envs import Hill


def first_pattern(steps: Integers, switches: int, gap: int, last: int) -> bool:
    """Write the earliest pattern: switch ``a`` in step ``a * gap``; whether it is one.

    Args:
        steps: filled with the steps of the switches, ascending.
        switches: how many there are.
        gap: least distance of two of them.
        last: the last step that a switch may be in.
    """
    for a in range(switches):
        steps[a] = a * gap
    return switches == 0 or (last >= 0 and bool(steps[switches - 1] <= last))


def next_pattern(steps: Integers, switches: int, gap: int, last: int) -> bool:
    """Write the pattern that follows, in lexical order; whether there is one.

    Args:
        steps: a pattern; changed in place.
        switches: how many there are.
        gap: least distance of two of them.
        last: the last step that a switch may be in.
    """
    a = switches - 1
    while a >= 0 and steps[a] + (switches - 1 - a) * gap >= last:
        a -= 1
    if a < 0:
        return False
    steps[a] += 1
    for later in range(a + 1, switches):
        steps[later] = steps[later - 1] + gap
    return True


def length(hill: Hill, position: float, switches: int, steps: Integers, coasting: int, most: int) -> int:
    """The steps to the goal of a drive from rest that ends with thrust right, at most ``most``.

    Args:
        hill: what is driven on, with its clips.
        position: where the drive starts.
        switches: how often the thrust changes its direction.
        steps: when.
        coasting: bit ``a`` tells whether there is no thrust in the step of switch ``a``.
        most: where to give up.
    """
    state = (position, 0.0)
    action, switch = (2 if switches % 2 == 0 else 0), 0
    for step in range(most):
        chosen = action
        if switch < switches and steps[switch] == step:
            action = 2 - action
            chosen = 1 if (coasting >> switch) & 1 else action
            switch += 1
        state, _, terminated = hill.step(state, chosen)
        if terminated:
            return step + 1
    return most


def shorten(
    hill: Hill,
    positions: Floats,
    spacing: Spacing,
    horizons: Integers,
    coast: bool,
    upper: Integers,
    steps: Integers,
) -> None:
    """Look for shorter drives among all patterns.

    Args:
        hill: what is driven on.
        positions: where the drives start, at rest; shape (starts,).
        spacing: of the switches.
        horizons: drives as long as this are not looked at; shape (starts,).
        coast: whether to try no thrust in the steps of the switches, too.
        upper: the fewest steps known, shape (starts,); lowered in place.
        steps: room for ``MAX_SWITCHES`` numbers.
    """
    for start in range(positions.shape[0]):
        most = min(upper[start], horizons[start])
        for switches in range(MAX_SWITCHES + 1):
            more = first_pattern(steps, switches, spacing.gap, most - 1 - spacing.last)
            while more:
                for coasting in range(1 << switches if coast else 1):
                    needed = length(hill, positions[start], switches, steps, coasting, most)
                    if needed < most:
                        upper[start] = most = needed
                more = next_pattern(steps, switches, spacing.gap, most - 1 - spacing.last)

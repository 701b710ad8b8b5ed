"""What a coasting car's energy does: both dynamics, both integrators, with and without friction.

    python scripts/energies.py --out docs/figures/energies.png

Each car starts at rest and gets no thrust for 5,000 units of time. Its energy per unit of mass is
``v^2 / 2 + g (f(x) + 1)`` with the simplified dynamics and ``v^2 (1 + f'^2) / 2 + g (f(x) + 1)`` with the
constrained ones (docs/physics.md). It is told as a share of what it takes to stand at the goal. Without
friction an exact solution keeps it constant.
"""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from arena.figures.style import LINES
from envs import Dynamics, Hill

COAST = 1
"""The action without thrust."""

CASES: dict[str, dict[str, Any]] = {
    "semi-implicit": {"integrator": "semi-implicit"},
    "explicit": {"integrator": "explicit"},
    "semi-implicit, a tenth of the step": {"integrator": "semi-implicit", "time_step": 0.1},
    "semi-implicit, friction k_f = 1": {"integrator": "semi-implicit", "friction": 1.0},
}


def energy(hill: Hill, position: float, velocity: float) -> float:
    """Per unit of mass, 0 at rest at the lowest point."""
    kinetic = 0.5 * velocity * velocity
    if hill.dynamics == Dynamics.CONSTRAINED:
        kinetic *= 1.0 + hill.slope(position) ** 2
    return kinetic + hill.gravity * (hill.height(position) + 1.0)


def coasting(hill: Hill, start: float, duration: float) -> NDArray[np.float64]:
    """The energy after each step, the start included, as a share of that at rest at the goal."""
    state = (start, 0.0)
    found = [energy(hill, *state)]
    for _ in range(round(duration / hill.time_step)):
        state, _, _ = hill.step(state, COAST)
        found.append(energy(hill, *state))
    return np.array(found) / energy(hill, hill.goal_position, 0.0)


def draw(found: dict[tuple[str, str], NDArray[np.float64]], duration: float, path: Path) -> None:
    """Side by side for both dynamics, with a common scale."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 4.5), layout="constrained")
    panels = figure.subplots(1, len(Dynamics), sharey=True)
    for axes, dynamics in zip(panels, Dynamics):
        for case, color, dashes in zip(CASES, LINES, ("-", "-", "--", "-.")):
            energies = found[dynamics.label, case]
            time = np.linspace(0.0, duration, len(energies))
            axes.plot(time, energies, color=color, linestyle=dashes, linewidth=0.9, label=case)
        axes.set(title=f"{dynamics.label} dynamics", xlabel="time (units of time)", ylim=0.0)
        axes.legend(frameon=False)
    panels[0].set_ylabel("energy (share of that at the goal)")
    figure.savefig(path, dpi=120)


def main() -> None:
    """Parse, coast, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--start", type=float, default=-0.9, help="position at rest")
    parser.add_argument("--duration", type=float, default=5000.0, help="units of time")
    parser.add_argument("--out", type=Path, help="file to draw the figure into")
    arguments = parser.parse_args()
    found = {
        (dynamics.label, case): coasting(
            Hill(dynamics=dynamics, **constants), arguments.start, arguments.duration
        )
        for dynamics in Dynamics
        for case, constants in CASES.items()
    }
    print(f"{'dynamics':12} {'case':36} {'start':>7} {'least':>7} {'most':>7} {'end':>7}")
    for (dynamics, case), shares in found.items():
        told = (shares[0], shares.min(), shares.max(), shares[-1])
        print(f"{dynamics:12} {case:36} {' '.join(f'{share:7.3f}' for share in told)}")
    if arguments.out:
        draw(found, arguments.duration, arguments.out)


if __name__ == "__main__":
    main()

"""Maps over position and velocity: the paper's Figures 5 and 6, values, and test drives."""

from collections.abc import Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from arena.analysis.policy_map import PolicyMap, map_of, policy, values, visits
from arena.figures.style import ACTION_NAMES, ACTIONS, AMOUNT, BLACK, DASHES, LINES, UNVISITED, make_axes
from arena.results.trained import Trained, UnknownPolicyError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_POSITION, _VELOCITY = "position (units of length)", "velocity (length / time)"
DRIVES = 5


def draw_policy(trained: Trained, axes: "Axes | None" = None, *, faint: bool = False) -> "Axes":
    """The action of the learned policy in each cell, with those that training never visited hatched.

    Args:
        trained: whose.
        axes: to draw on; None makes a figure.
        faint: pale, as a ground for something else.

    Raises:
        UnknownPolicyError: when it drives by chance.
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    where = map_of(trained)
    actions, counts = policy(trained, where), visits(trained, where)
    axes = make_axes(axes)
    alpha = 0.35 if faint else 1.0
    lines: dict[str, Any] = {"edgecolors": "#999999", "linewidth": 0.2} if where.exact else {}
    axes.pcolormesh(
        *_corners(where),
        actions.T,
        cmap=ListedColormap(ACTIONS),
        vmin=-0.5,
        vmax=2.5,
        alpha=alpha,
        **lines,
    )
    shown = [
        Patch(facecolor=color, edgecolor="#00000060", alpha=alpha, label=name)
        for color, name in zip(ACTIONS, ACTION_NAMES)
    ]
    if counts is not None and not counts.sum(axis=2).all():
        shown.append(_hatch(axes, where, counts.sum(axis=2) == 0))
    _label(axes, trained, "policy", where)
    axes.figure.legend(handles=shown, loc="outside lower center", ncols=4, frameon=False)
    return axes


def draw_visits(trained: Trained, figure: "Figure | None" = None) -> "Figure":
    """How often each action was taken in each cell while it learned, and all together.

    Four maps with one logarithmic scale; cells that were never visited are hatched.

    Raises:
        UnknownPolicyError: when the agent has no counts of the cells of a grid.
    """
    from matplotlib import figure as figures
    from matplotlib.colors import LogNorm

    where = map_of(trained)
    counts = visits(trained, where)
    if counts is None:
        raise UnknownPolicyError(f"{trained.entrant!r} counts no visits of the cells of a grid")
    figure = figure or figures.Figure(figsize=(9.0, 6.5), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    total = counts.sum(axis=2)
    norm = LogNorm(1, max(10, total.max()))
    shown = [*(counts[:, :, action] for action in range(counts.shape[2])), total]
    for axes, name, count in zip(panels.flat, (*ACTION_NAMES, "all actions"), shown):
        _hatch(axes, where, count == 0)
        mesh = axes.pcolormesh(*_corners(where), np.ma.masked_equal(count, 0).T, cmap=AMOUNT, norm=norm)
        axes.set_title(f"{name}: {count.sum():,}")
        axes.label_outer()
    figure.colorbar(mesh, ax=panels, label="times in training (logarithmic; hatched: never)")
    figure.supxlabel(_POSITION)
    figure.supylabel(_VELOCITY)
    figure.suptitle(f"{trained.entrant}, replicate {trained.replicate}: visits")
    return figure


def draw_value(trained: Trained, figure: "Figure | None" = None) -> "Figure":
    """The steps to go that the agent expects, discounted: minus its values; a heat map and a surface.

    Raises:
        UnknownPolicyError: when the agent has no values.
    """
    from matplotlib import figure as figures

    where = map_of(trained)
    costs = expected_costs(trained, where)
    figure = figure or figures.Figure(figsize=(11.0, 4.8), layout="constrained")
    flat = figure.add_subplot(1, 2, 1)
    unknown = np.ma.getmaskarray(costs)
    handles = [_hatch(flat, where, unknown)] if unknown.any() else []
    mesh = flat.pcolormesh(*_corners(where), costs.T, cmap=AMOUNT)
    flat.set(xlabel=_POSITION, ylabel=_VELOCITY)
    figure.suptitle(_title(trained, "minus the value of the best action", where))
    figure.colorbar(mesh, ax=flat, label="expected discounted steps to the goal")
    if handles:
        flat.legend(handles=handles, loc="upper right")
    surface: Any = figure.add_subplot(1, 2, 2, projection="3d")
    x, v = (0.5 * (edges[1:] + edges[:-1]) for edges in (where.positions, where.velocities))
    surface.plot_surface(*np.meshgrid(x, v), costs.filled(np.nan).T, cmap=AMOUNT, linewidth=0)
    surface.set(xlabel="position", ylabel="velocity", zlabel="steps")
    surface.locator_params(nbins=5)
    surface.set_box_aspect(None, zoom=0.8)
    return figure


def expected_costs(trained: Trained, where: PolicyMap) -> "np.ma.MaskedArray[Any, Any]":
    """Minus the value of the best action in each cell, shape (m, n); masked where training never was.

    Raises:
        UnknownPolicyError: when the agent has no values.
    """
    cell_values, counts = values(trained, where), visits(trained, where)
    if cell_values is None:
        raise UnknownPolicyError(f"{trained.entrant!r} has no values of actions to draw")
    unknown = np.zeros(cell_values.shape, bool) if counts is None else counts.sum(axis=2) == 0
    return np.ma.MaskedArray(-cell_values, unknown)


def draw_phase(trained: Trained, axes: "Axes | None" = None, starts: Sequence[float] | None = None) -> "Axes":
    """Test drives as paths over the policy map.

    Args:
        trained: who drives.
        axes: to draw on; None makes a figure.
        starts: positions; by default ``DRIVES`` evenly over the range of starts.

    Raises:
        UnknownPolicyError: when it drives by chance.
    """
    axes = make_axes(axes, 9.0)
    axes = draw_policy(trained, axes, faint=True)
    hill = trained.hill
    if starts is None:
        starts = np.linspace(hill.min_start, hill.max_start, DRIVES).tolist()
    drives = []
    for start, color, dashes in zip(starts, cycle(LINES), cycle(DASHES)):
        path = trained.drive(start)
        steps = f"{len(path) - 1} steps"
        arrived = path[-1, 0] >= hill.goal_position
        label = f"from {start:.2f}: " + (steps if arrived else f"not there in {steps}")
        drives += axes.plot(*path.T, color=color, linestyle=dashes, linewidth=1.4, label=label)
        axes.plot(*path[0], "o", color=color, markersize=5)
    axes.axvline(hill.goal_position, color=BLACK, linewidth=1.2)
    axes.figure.legend(handles=drives, loc="outside right center", frameon=False)
    axes.set_title(f"{trained.entrant}, replicate {trained.replicate}: drives over the policy")
    return axes


def _corners(where: PolicyMap) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return where.positions, where.velocities


def _hatch(axes: "Axes", where: PolicyMap, cells: NDArray[np.bool_]) -> Any:
    """Mark these cells; what stands for them in a legend."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    marked = np.ma.masked_equal(cells.astype(float), 0.0)
    axes.pcolor(*_corners(where), marked.T, cmap=ListedColormap([UNVISITED]), hatch="////", linewidth=0)
    return Patch(facecolor=UNVISITED, hatch="////", edgecolor="#777777", label="never visited")


def _label(axes: "Axes", trained: Trained, what: str, where: PolicyMap) -> None:
    axes.set(xlabel=_POSITION, ylabel=_VELOCITY, title=_title(trained, what, where))


def _title(trained: Trained, what: str, where: PolicyMap) -> str:
    asked = "" if where.exact else " (asked on a fine grid)"
    return f"{trained.entrant}, replicate {trained.replicate}: {what}{asked}"

import itertools
import math
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from agents.optimal import NEVER, Optimal, optimal_steps
from agents.optimal.bang_bang import first_pattern, next_pattern, shorten
from agents.optimal.boxes import Boxes
from agents.optimal.certificate import Limit, Segment, first_beyond
from agents.optimal.conservative_cells import cell_of, fewest_steps, image
from agents.optimal.lower_bound import departure, lower_bound
from agents.optimal.relaxed_car import MAX_SWITCHES, Relaxed, Spacing, patterns, spacing
from arena import Entrant
from arena.execution.loops import EvaluationLoop, evaluate
from arena.testing import parametrize_with_checks
from envs import Hill
from envs.compilation import compile_loop

Floats = NDArray[np.float64]
DEPTH = 9  # steps of the drives that are all tried
CELLS = (60, 60)


@st.composite
def hills(draw: st.DrawFn) -> Hill:
    """Hills with so long time steps that the goal is often a few steps and switches away."""
    fastest = draw(st.sampled_from([1.0, 0.07, 0.03]))
    return Hill(
        omega=draw(st.floats(1.0, 5.0)),
        gravity=draw(st.sampled_from([0.0, 0.0025 / 3, 0.001, 0.002])),
        friction=draw(st.sampled_from([0.0, 0.0, 20.0])),
        time_step=draw(st.floats(3.0, 14.0)),
        thrust=draw(st.floats(0.3, 3.0)),
        min_position=draw(st.sampled_from([-1.2, -0.8, -0.6])),
        goal_position=draw(st.floats(-0.3, 0.5)),
        min_velocity=-fastest * draw(st.sampled_from([0.5, 1.0])),
        max_velocity=fastest,
        min_start=-0.6,
        max_start=-0.4,
        inelastic_wall=draw(st.booleans()),
        integrator=draw(st.sampled_from(["semi-implicit", "explicit"])),
        dynamics=draw(st.sampled_from(["simplified", "simplified", "constrained"])),
    )


def drive_relaxed(car: Relaxed, x: Any, v: Any, thrusts: Any) -> tuple[Any, Any]:
    """Positions and velocities after each step; the thrusts are numbers or arrays of complex numbers."""
    positions, velocities = [], []
    for u in thrusts:
        before = v
        v = car.keep * v + car.impulse * u - car.pull * np.cos(car.omega * x)
        x = x + car.time_step * (before if car.explicit else v)
        positions.append(x)
        velocities.append(v)
    return positions, velocities


# The theory


@given(hills(), st.integers(0, 2**32 - 1))
@settings(max_examples=100, deadline=None)
def test_sensitivities_change_their_signs_no_sooner_than_the_spacing_says(hill: Hill, seed: int) -> None:
    car, rng, n = Relaxed.of(hill), np.random.default_rng(seed), 30
    assume(car.applies)
    thrusts = np.sign(rng.normal() + rng.normal(size=n)) * rng.choice([1.0, rng.random()], n)
    tiny = 1e-30  # derivatives by complex steps, one column for the impulse in each step
    columns = np.eye(n) * tiny * 1j / car.impulse + thrusts[:, None]
    ends = drive_relaxed(car, np.full(n, rng.uniform(-0.6, -0.4) + 0j), np.zeros(n) + 0j, columns)
    for of_velocity in (False, True):
        distance = spacing(car, of_velocity=of_velocity)
        sensitivities = ends[of_velocity][-1].imag / tiny
        if car.explicit and not of_velocity:
            assert sensitivities[-1] == 0.0
        signs = np.sign(sensitivities[: n - 1] if car.explicit and not of_velocity else sensitivities)
        changes = np.flatnonzero(np.diff(signs)) + 1
        assert signs[-1] == 1.0
        assert not len(changes) or n - changes[-1] >= distance.last
        assert all(np.diff(changes) >= distance.gap)


def test_spacing_on_the_default_hill() -> None:
    # Sturm: half a period pi / theta, cos(theta) = 1 - 0.0075 / 2, is 36.27 steps.
    assert math.pi / math.acos(1 - 0.0075 / 2) == pytest.approx(36.27, abs=0.01)
    assert spacing(Relaxed.of(Hill()), of_velocity=False) == (36, 36)
    assert spacing(Relaxed.of(Hill()), of_velocity=True) == (36, 18)


def test_without_gravity_a_drive_has_no_switch() -> None:
    distance = spacing(Relaxed.of(Hill(gravity=0.0, friction=10.0)), of_velocity=False)
    assert patterns(distance, 100_000) == 1


@given(st.integers(1, 5), st.integers(1, 6), st.integers(1, 12))
@settings(max_examples=40, deadline=None)
def test_all_patterns_are_written_and_counted(gap: int, last: int, horizon: int) -> None:
    steps, expected = np.zeros(MAX_SWITCHES, np.int64), set()
    for switches in range(MAX_SWITCHES + 1):
        for chosen in itertools.combinations(range(max(horizon - last + 1, 0)), switches):
            if all(b - a >= gap for a, b in itertools.pairwise(chosen)):
                expected.add(chosen)
    written = []
    for switches in range(MAX_SWITCHES + 1):
        more = first_pattern(steps, switches, gap, horizon - last)
        while more:
            written.append(tuple(map(int, steps[:switches])))
            more = next_pattern(steps, switches, gap, horizon - last)
    assert len(written) == len(set(written))
    assert set(written) == expected
    if horizon - last < MAX_SWITCHES:
        assert patterns(Spacing(gap, last), horizon) == len(expected)


# The certificate


@given(hills(), st.floats(-2.0, 2.0), st.floats(0.1, 2.0))
@settings(deadline=None)
def test_growth_is_the_norm_of_a_steps_matrix(hill: Hill, steepness: float, scale: float) -> None:
    car = Relaxed.of(hill)
    h, slope = car.time_step, steepness / car.time_step
    push = np.array([[1.0, 0.0], [slope, car.keep]])  # of the velocity
    move = np.array([[1.0, h], [0.0, 1.0]])
    matrix = np.array([[1.0, h], [slope, car.keep]]) if car.explicit else move @ push
    unit = np.diag([scale, 1.0])
    expected = np.linalg.norm(unit @ matrix @ np.linalg.inv(unit), 2)
    assert car.growth(scale, slope) == pytest.approx(expected, rel=1e-9)


@given(hills(), st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from([1.0, -1.0]))
@settings(max_examples=150, deadline=None)
@pytest.mark.exhaustive
def test_no_drive_of_a_box_is_further_than_the_box(
    hill: Hill, seed: int, of_velocity: bool, sign: float
) -> None:
    car, rng, boxes = Relaxed.of(hill), np.random.default_rng(seed), Boxes.make()
    n = int(rng.choice([1, 2, 3, 14]))  # the fewer, the tighter
    switches = int(rng.integers(min(n, 3)))
    steps = np.sort(rng.choice(n - 1, switches, replace=False))
    boxes.steps[:switches] = steps
    boxes.halves[0] = rng.choice([0.0, 0.1, 0.5, 1.0], MAX_SWITCHES + 1)
    boxes.middles[0] = rng.uniform(-1.0, 1.0, MAX_SWITCHES + 1) * (1.0 - boxes.halves[0])
    sides = rng.choice([0.0, 0.01, 0.1, 0.5], 2) * (1.0, hill.max_velocity)
    start = Segment(rng.uniform(-1.2, 0.5), 0.0, *sides)
    for _ in range(10):
        corner = rng.choice([-1.0, 1.0, rng.uniform(-1.0, 1.0)], MAX_SWITCHES + 1)
        inside = boxes.middles[0] + boxes.halves[0] * corner
        blocks = (-1.0) ** (switches - np.searchsorted(steps, np.arange(n), side="right"))
        thrusts = sign * blocks
        thrusts[steps] = inside[:switches]
        x, v = start.position + inside[switches] * start.length, inside[switches] * start.speed
        ends = drive_relaxed(car, x, v, thrusts)
        furthest = sign * ends[of_velocity][-1]
        limit = Limit(of_velocity, sign, furthest, Spacing(1, 1))
        with np.errstate(over="ignore", invalid="ignore"):  # a box that is too large; it is halved then
            assert first_beyond(car, start, limit, switches, 0, n + 1, boxes) <= n


# The lower bound against all drives there are


def expand(hill: Hill, states: Floats, following: Floats) -> bool:
    """Take all actions in all states; whether one leads to the goal."""
    reached = False
    for i in range(len(states)):
        for action in range(3):
            state, _, terminated = hill.step((states[i, 0], states[i, 1]), action)
            following[3 * i + action, 0], following[3 * i + action, 1] = state
            reached = reached or terminated
    return reached


def fewest_by_trying_all(hill: Hill, position: float) -> int:
    states = np.array([[position, 0.0]])
    for steps in range(1, DEPTH + 1):
        following = np.zeros((3 * len(states), 2))
        if compile_loop(expand, hill, states, following)(hill, states, following):
            return steps
        states = following
    return DEPTH + 1


def proved(hill: Hill, position: float) -> tuple[int, int]:
    """The lower bounds of the theory and of the cells."""
    cells = fewest_steps(hill, CELLS)
    most = np.array([DEPTH + 1])
    lower = lower_bound(hill, np.array([position]), most, cells.reshape(CELLS))
    return int(lower[0]), int(cells[cell_of(hill, CELLS, position, 0.0)])


@given(hills(), st.floats(-0.6, -0.4))
@settings(max_examples=60, deadline=None)
def test_lower_bounds_hold_against_all_drives(hill: Hill, position: float) -> None:
    assume(Relaxed.of(hill).applies)
    fewest = fewest_by_trying_all(hill, position)
    lower, by_cells = proved(hill, position)
    assert lower <= fewest
    assert by_cells <= fewest or fewest == DEPTH + 1


@given(hills(), st.integers(0, 2**32 - 1))
@settings(max_examples=100, deadline=None)
@pytest.mark.exhaustive
def test_an_action_leads_from_a_cell_into_its_image(hill: Hill, seed: int) -> None:
    rng = np.random.default_rng(seed)
    low = rng.uniform(hill.low, hill.high)
    high = np.minimum(low + rng.choice([1e-6, 0.01, 0.3], 2) * (1.0, hill.max_velocity), hill.high)
    for state in (*rng.uniform(low, high, (20, 2)), *itertools.product(*zip(low, high, strict=True))):
        for action in range(3):
            (x, v), _, _ = hill.step((float(state[0]), float(state[1])), action)
            left, right, slowest, fastest = image(hill, tuple(low), tuple(high), action)
            assert min(left, hill.max_position) - 1e-12 <= x <= max(right, hill.min_position) + 1e-12
            assert slowest - 1e-12 <= v <= fastest + 1e-12


@given(hills(), st.integers(0, 2**32 - 1))
@settings(max_examples=150, deadline=None)
@pytest.mark.exhaustive
def test_car_leaves_the_wall_as_is_said(hill: Hill, seed: int) -> None:
    assume(Relaxed.of(hill).applies)
    rng, (segment,) = np.random.default_rng(seed), departure(hill)
    position, middle, length, half = segment
    assert (position, length) == (hill.min_position, 0.0)
    for _ in range(20):
        state = (float(rng.uniform(hill.min_position, -0.4)), 0.0)
        for action in rng.integers(3, size=30):
            following, _, _ = hill.step(state, int(action))
            if state[0] == hill.min_position < following[0]:
                assert abs(state[1] - middle) <= half
            state = following


# Hills where a drive that hits the inelastic wall, an instant brake, is shorter by a step.
WALLS = [
    (7, {"omega": 2.176, "gravity": 0.0012034, "time_step": 8.42, "thrust": 1.63, "goal_position": 0.4}),
    (
        3,
        {
            "omega": 2.3253,
            "gravity": 0.001613,
            "time_step": 12.89,
            "thrust": 1.93,
            "min_position": -0.818,
            "goal_position": 0.054,
        },
    ),
    (
        7,
        {
            "omega": 2.3153,
            "gravity": 0.0017938,
            "time_step": 5.97,
            "thrust": 1.69,
            "min_position": -0.823,
            "goal_position": -0.217,
            "min_velocity": -1.0,
            "max_velocity": 1.0,
            "integrator": "explicit",
        },
    ),
]


@pytest.mark.parametrize(("fewest", "constants"), WALLS)
def test_lower_bound_knows_that_the_wall_may_help(fewest: int, constants: dict[str, Any]) -> None:
    hill = Hill(min_start=-0.5, max_start=-0.5, **constants)
    assert fewest_by_trying_all(hill, -0.5) == fewest
    assert proved(hill, -0.5)[0] <= fewest
    assert proved(hill._replace(min_position=-50.0), -0.5)[0] == fewest + 1


@pytest.mark.parametrize("position", [-0.58, -0.5, -0.47, -0.43])
def test_relaxed_car_cannot_climb_past_the_bound(position: float) -> None:
    # An attack on the certificate: the best two switches, then thrusts moved uphill along the gradient.
    hill, (lower, _) = Hill(), optimal_steps(Hill(), position)
    car, furthest = Relaxed.of(hill), []
    for n in (int(lower) - 1, int(lower)):
        step, (second, third) = np.arange(n)[:, None], np.triu_indices(n)
        plans = np.where((step >= second) & (step < third), -1.0, 1.0)
        rest = np.zeros(len(second))
        ends = drive_relaxed(car, rest + position, rest, plans)[0][-1]
        thrusts, best = plans[:, ends.argmax()], ends.max()
        for pace in (1.0, 0.3, 0.1, 0.03, 0.01) * 2:
            columns = np.eye(n) * 1e-30j + thrusts[:, None]
            slope = drive_relaxed(car, np.full(n, position + 0j), np.zeros(n) + 0j, columns)[0][-1].imag
            trial = np.clip(thrusts + pace * slope / abs(slope).max(), -1.0, 1.0)
            end = drive_relaxed(car, position, 0.0, trial)[0][-1]
            if end > best:
                thrusts, best = trial, end
        furthest.append(best)
    assert furthest[0] < hill.goal_position <= furthest[1]


# The answers


def shortest_of_two_switches(hill: Hill, positions: Floats, most: int, found: NDArray[np.int64]) -> None:
    for start in range(len(positions)):
        for first in (0, 2):
            for second in range(most):
                for third in range(second, most):
                    state, step, there = (positions[start], 0.0), 0, False
                    while step < most and step < found[start] and not there:
                        state, _, there = hill.step(state, 2 - first if second <= step < third else first)
                        step += 1
                    if there:
                        found[start] = min(found[start], step)


def test_optimum_is_that_of_a_search_that_knows_no_theory() -> None:
    hill = Hill()
    positions = np.append(np.random.default_rng(1).uniform(-0.6, -0.4, 10), [-0.6, -0.5, -0.45, -0.4])
    found = np.full(len(positions), 106)
    arguments = (hill, positions, 106, found)
    compile_loop(shortest_of_two_switches, *arguments)(*arguments)
    lower, upper = optimal_steps(hill, positions)
    assert upper.tolist() == lower.tolist() == found.tolist()
    assert upper[-4:].tolist() == [104, 102, 91, 83]


def test_search_finds_the_shortest_drives_by_itself() -> None:
    positions, found = np.array([-0.6, -0.5, -0.45, -0.4]), np.full(4, 107)
    distance = spacing(Relaxed.of(Hill()), of_velocity=False)
    arguments = (Hill(), positions, distance, found.copy(), False, found, np.zeros(MAX_SWITCHES, np.int64))
    compile_loop(shorten, *arguments)(*arguments)
    assert found.tolist() == [104, 102, 91, 83]


def test_optimum_from_the_default_starts() -> None:
    positions = np.random.default_rng(2).uniform(-0.6, -0.4, 200)
    lower, upper = optimal_steps(Hill(), positions)
    assert lower.tolist() == upper.tolist()
    assert upper.mean() == pytest.approx(97.65, abs=4 * 7.3 / math.sqrt(200))
    assert (upper.min(), upper.max()) == (83, 104)


@pytest.mark.parametrize(
    "constants",
    [
        {"integrator": "explicit"},
        {"inelastic_wall": False},
        {"time_step": 2.0},
        {"friction": 50.0, "thrust": 2.5},
    ],
)
def test_optimum_is_certified_on_other_hills(constants: dict[str, Any]) -> None:
    lower, upper = optimal_steps(Hill(**constants), [-0.6, -0.55, -0.5, -0.45, -0.4])
    assert lower.tolist() == upper.tolist()


def test_goal_out_of_reach_is_proved_to_be() -> None:
    lower, upper = optimal_steps(Hill(friction=50.0), [-0.5])
    assert lower.tolist() == upper.tolist() == [NEVER]


def test_gap_is_told_where_no_more_is_proved() -> None:
    hill = Hill(friction=2000.0, thrust=10.0)  # friction that turns the car around: the theory does not apply
    lower, upper = optimal_steps(hill, [-0.5])
    assert 0 < lower[0] < upper[0] == NEVER


def test_answers_keep_their_shape() -> None:
    positions = np.array([[-0.5, -0.45, -0.5]])
    lower, upper = optimal_steps(Hill(), positions)
    assert lower.shape == upper.shape == positions.shape
    assert lower.dtype == upper.dtype == np.int64
    assert upper.tolist() == [[102, 91, 102]]
    assert optimal_steps(Hill(), -0.5)[1] == 102
    assert optimal_steps(Hill(), [])[0].shape == (0,)


def test_answers_are_computed_once() -> None:
    hill, positions = Hill(friction=1.25), np.linspace(-0.59, -0.41, 60)  # no other test asks for these
    began = time.perf_counter()
    first = optimal_steps(hill, positions)
    computed = time.perf_counter()
    again = optimal_steps(hill, positions)
    assert time.perf_counter() - computed < (computed - began) / 10
    assert [bound.tolist() for bound in again] == [bound.tolist() for bound in first]


@pytest.mark.parametrize("bad", [-1.3, 0.61, math.nan])
def test_position_beside_the_hill_is_refused(bad: float) -> None:
    with pytest.raises(ValueError, match=r"^positions must be .*, got "):
        optimal_steps(Hill(), [-0.5, bad])


def test_what_is_no_hill_is_refused() -> None:
    with pytest.raises(TypeError, match=r"^hill must be a Hill"):
        optimal_steps("hill", [-0.5])  # type: ignore[arg-type]


# The driver


def driven(hill: Hill, agent: Any, positions: Floats) -> NDArray[np.int64]:
    starts = np.stack([positions, np.zeros_like(positions)], axis=1)
    lengths, reached = np.zeros(len(starts), np.int64), np.zeros(len(starts), np.bool_)
    loop = EvaluationLoop(hill, agent, 3, starts, 200, lengths, reached)
    compile_loop(evaluate, loop)(loop)
    assert reached.all()
    return lengths


@parametrize_with_checks([Entrant("optimal", Optimal)])
def test_contract(entrant: Any, check: Any) -> None:
    check(entrant)


def test_optimal_driver_needs_the_fewest_steps_from_nearly_all_starts() -> None:
    positions = np.random.default_rng(3).uniform(-0.6, -0.4, 250)
    _, upper = optimal_steps(Hill(), positions)
    excess = driven(Hill(), Optimal.create(Hill()), positions) - upper
    assert excess.min() == 0
    assert excess.max() <= 1
    assert excess.mean() <= 0.01


def test_optimal_driver_reaches_the_goal_on_a_hill_with_the_explicit_integrator() -> None:
    hill, positions = Hill(integrator="explicit"), np.linspace(-0.6, -0.4, 5)
    excess = driven(hill, Optimal.create(hill), positions) - optimal_steps(hill, positions)[1]
    assert excess.min() >= 0
    assert excess.max() <= 1


def test_optimal_driver_refuses_what_it_cannot_plan_for() -> None:
    with pytest.raises(ValueError, match=r"^friction must be less"):
        Optimal.create(Hill(friction=2000.0))
    with pytest.raises(ValueError, match=r"^dynamics must be simplified for this agent, got 'constrained'$"):
        Optimal.create(Hill(dynamics="constrained"))
    with pytest.raises(TypeError, match=r"^task must be a Hill"):
        Optimal.create("hill")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^bins must"):
        Optimal.create(Hill(), bins=0)

import math
import pickle
import re
from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from envs import Dynamics, Hill, Integrator, mountain_car_v0, single_car_v0
from envs.compilation import compile_loop

Floats = NDArray[np.float64]

HILLS = {
    "default": Hill(),
    "friction": Hill(friction=50.0),
    "explicit": Hill(integrator="explicit"),
    "elastic": Hill(inelastic_wall=False),
    "constrained": Hill(dynamics="constrained", friction=50.0),
    "other": Hill(omega=2.5, mass=700.0, gravity=0.001, time_step=0.3, thrust=1.3),
}


def step_each(hill: Hill, states: Floats, actions: NDArray[np.int64], found: Floats) -> None:
    for i in range(len(actions)):
        state, reward, terminated = hill.step((states[i, 0], states[i, 1]), actions[i])
        found[i, 0], found[i, 1] = hill.observe(state)
        found[i, 2] = reward
        found[i, 3] = terminated
        found[i, 4] = hill.height(states[i, 0])
        found[i, 5] = hill.slope(states[i, 0])


def walk_at_random(hill: Hill, rng: np.random.Generator, lengths: NDArray[np.int64]) -> None:
    for walk in range(len(lengths)):
        state = hill.reset(rng)
        terminated = False
        while not terminated:
            state, _, terminated = hill.step(state, int(rng.random() * 3))
            lengths[walk] += 1


def bits(*numbers: float) -> bytes:
    return np.array(numbers, np.float64).tobytes()


@pytest.fixture(scope="module")
def gym() -> Any:
    return gymnasium.make("MountainCar-v0").unwrapped


def test_starts_are_those_of_gymnasium_to_the_bit(gym: Any) -> None:
    for seed in range(1000):
        gym.reset(seed=seed)
        assert bits(*Hill().reset(np.random.Generator(np.random.PCG64(seed)))) == bits(*gym.state)


def test_trajectories_are_those_of_gymnasium_to_the_bit(gym: Any) -> None:
    hill, rng = Hill(), np.random.default_rng(1)
    terminated = False
    seen = np.zeros(4, np.int64)
    for step, action in enumerate(rng.integers(3, size=100_000)):
        if terminated or step % 100 == 0:
            start = hill.reset(rng) if step % 200 else rng.uniform(hill.low, (hill.goal_position, 0.07))
            gym.state = np.array(start)
            state = (float(start[0]), float(start[1]))
        _, _, expected, _, _ = gym.step(action)
        state, reward, terminated = hill.step(state, int(action))
        assert bits(*state) == bits(*gym.state)
        assert (reward, terminated) == (-1.0, expected)
        seen += (terminated, state[0] == hill.min_position, abs(state[1]) == 0.07, state[0] < -1.0)
    assert min(seen) > 100  # all the branches were compared


@pytest.mark.parametrize("name", HILLS)
def test_compiled_hill_equals_the_interpreted_one_to_the_bit(name: str) -> None:
    hill, rng = HILLS[name], np.random.default_rng(2)
    corners = [(x, v) for x in (-1.2, -0.5, 0.0, 0.5, 0.6) for v in (-0.07, -0.0, 0.0, 0.07)]
    states = np.concatenate([rng.uniform(hill.low, hill.high, (5000, 2)), corners])
    actions = rng.integers(3, size=len(states))
    interpreted, compiled = np.zeros((len(states), 6)), np.zeros((len(states), 6))
    step_each(hill, states, actions, interpreted)
    compile_loop(step_each, hill, states, actions, compiled)(hill, states, actions, compiled)
    assert compiled.tobytes() == interpreted.tobytes()


STEPS: list[tuple[Hill, tuple[float, float], int, tuple[float, float]]] = [
    # At 0 the slope is omega, so gravity pulls with -0.0025; the thruster adds -0.001, 0 or 0.001.
    (Hill(), (0.0, 0.0), 0, (-0.0035, -0.0035)),
    (Hill(), (0.0, 0.0), 1, (-0.0025, -0.0025)),
    (Hill(), (0.0, 0.0), 2, (-0.0015, -0.0015)),
    (Hill(), (-math.pi / 6, 0.0), 2, (0.001 - math.pi / 6, 0.001)),  # the bottom is flat
    (Hill(integrator="explicit"), (0.0, 0.02), 2, (0.02, 0.0185)),
    (Hill(), (0.0, 0.02), 2, (0.0185, 0.0185)),
    (Hill(friction=100.0), (0.0, 0.05), 1, (0.0425, 0.0425)),
    (Hill(friction=100.0), (0.0, -0.05), 1, (-0.0475, -0.0475)),
    (Hill(mass=500.0), (0.0, 0.0), 2, (-0.0005, -0.0005)),
    (Hill(mass=500.0, friction=100.0), (0.0, 0.05), 1, (0.0375, 0.0375)),
    (Hill(thrust=3.0), (0.0, 0.0), 2, (0.0005, 0.0005)),
    (Hill(gravity=0.001), (0.0, 0.0), 1, (-0.003, -0.003)),
    (Hill(omega=6.0), (0.0, 0.0), 1, (-0.005, -0.005)),
    (Hill(omega=6.0), (-math.pi / 12, 0.0), 1, (-math.pi / 12, 0.0)),
    (Hill(time_step=0.5), (0.0, 0.02), 2, (0.009625, 0.01925)),
    (Hill(time_step=0.5, integrator="explicit"), (0.0, 0.02), 2, (0.01, 0.01925)),
    (Hill(gravity=0.0), (-1.19, -0.05), 1, (-1.2, 0.0)),
    (Hill(gravity=0.0, inelastic_wall=False), (-1.19, -0.05), 1, (-1.2, -0.05)),
    (Hill(gravity=0.0), (-1.2, 0.0), 2, (-1.199, 0.001)),
    (Hill(gravity=0.0), (0.0, 0.0695), 2, (0.07, 0.07)),
    (Hill(gravity=0.0), (0.0, -0.0695), 0, (-0.07, -0.07)),
    (Hill(gravity=0.0, integrator="explicit"), (0.0, 0.0695), 2, (0.0695, 0.07)),
    (Hill(gravity=0.0), (0.59, 0.05), 1, (0.6, 0.05)),
    # Constrained at 0: f' = 3, f'' = 0, so a tenth of the simplified acceleration.
    (Hill(dynamics="constrained"), (0.0, 0.0), 1, (-0.00025, -0.00025)),
    # Constrained at pi / 12: f'^2 = 9/2, f' f'' = -27/2, so 27/11 v^2 without forces.
    (
        Hill(dynamics="constrained", gravity=0.0),
        (math.pi / 12, 0.02),
        1,
        (math.pi / 12 + 0.02 + 0.0108 / 11, 0.02 + 0.0108 / 11),
    ),
]


@pytest.mark.parametrize(("hill", "state", "action", "expected"), STEPS)
def test_step_computed_by_hand(
    hill: Hill, state: tuple[float, float], action: int, expected: tuple[float, float]
) -> None:
    found, reward, _ = hill.step(state, action)
    assert found == pytest.approx(expected, rel=0.0, abs=1e-15)
    assert reward == -1.0


def test_goal_is_reached_at_its_position_and_not_before() -> None:
    hill = Hill(gravity=0.0)
    just_further = hill._replace(goal_position=math.nextafter(0.5, 1.0))
    assert hill.step((0.4375, 0.0625), 1) == ((0.5, 0.0625), -1.0, True)
    assert just_further.step((0.4375, 0.0625), 1) == ((0.5, 0.0625), -1.0, False)


def test_start_is_at_rest_between_its_bounds_and_draws_one_number() -> None:
    rng, same = np.random.default_rng(3), np.random.default_rng(3)
    hill = Hill(min_start=-1.0, max_start=-0.75)
    for _ in range(100):
        assert hill.reset(rng) == (-1.0 + 0.25 * same.random(), 0.0)


def test_friction_and_nothing_else_takes_the_energy_of_a_coasting_car() -> None:
    def left(hill: Hill) -> float:
        state = (-math.pi / 6, 0.01)
        for _ in range(1000):
            state, _, _ = hill.step(state, 1)
        return (state[1] ** 2 / 2 + hill.gravity * (hill.height(state[0]) + 1.0)) / (0.01**2 / 2)

    assert left(Hill()) == pytest.approx(1.0, abs=0.1)
    assert left(Hill(friction=10.0)) < 0.001


def test_constrained_dynamics_are_those_of_a_bead_on_the_curve() -> None:
    start, end = (-0.9, 0.0), 200.0  # three swings

    def bead(_: float, state: Floats) -> Floats:
        """Newton's law with the force of the curve as an unknown, per unit of mass."""
        x, v = state
        slope, bend = 3.0 * math.cos(3.0 * x), -9.0 * math.sin(3.0 * x)
        # Unknown: x'', y'' and the force N of the curve, along (-slope, 1).
        matrix = [[1.0, 0.0, slope], [0.0, 1.0, -1.0], [-slope, 1.0, 0.0]]
        return np.array([v, np.linalg.solve(matrix, [0.0, -Hill().gravity, bend * v * v])[0]])

    def energy(x: Any, v: Any) -> Any:
        return v**2 * (1.0 + (3.0 * np.cos(3.0 * x)) ** 2) / 2.0 + Hill().gravity * (np.sin(3.0 * x) + 1.0)

    def coast(time_step: float) -> tuple[float, float]:
        hill, state = Hill(dynamics="constrained", time_step=time_step), start
        for _ in range(round(end / time_step)):
            state, _, _ = hill.step(state, 1)
        return state

    exact = solve_ivp(bead, (0.0, end), start, method="DOP853", rtol=1e-11, atol=1e-13).y
    assert np.ptp(energy(*exact)) < 1e-8 * energy(*start)
    coarse, fine = (math.dist(coast(time_step), exact[:, -1]) for time_step in (0.02, 0.01))
    assert fine < 5e-3
    assert coarse / fine == pytest.approx(2.0, abs=0.1)  # Euler's method is of first order


@pytest.mark.parametrize("omega", [0.7, 3.0])
@pytest.mark.parametrize("position", [-1.2, -math.pi / 6, 0.0, 0.31])
def test_slope_is_the_derivative_of_the_height(omega: float, position: float) -> None:
    hill, d = Hill(omega=omega), 1e-5
    assert hill.height(position) == math.sin(omega * position)
    difference = (hill.height(position + d) - hill.height(position - d)) / (2 * d)
    assert hill.slope(position) == pytest.approx(difference, abs=1e-8)


def test_random_walks_are_as_long_as_in_the_paper() -> None:
    hill, rng, lengths = Hill(), np.random.default_rng(4), np.zeros(300, np.int64)
    compile_loop(walk_at_random, hill, rng, lengths)(hill, rng, lengths)
    assert lengths.mean() == pytest.approx(42_300, abs=4 * 40_000 / math.sqrt(300))


def test_the_step_to_the_goal_has_a_reward_of_its_own() -> None:
    state = (0.499, 0.05)
    for hill, reward in ((Hill(), -1.0), (Hill(goal_reward=0.0), 0.0), (Hill(goal_reward=100.0), 100.0)):
        there, received, reached = hill.step(state, 2)
        assert (received, reached) == (reward, True)
        assert hill.step((-0.5, 0.0), 2)[1:] == (-1.0, False)
        car = single_car_v0.SingleCarEnv(hill)
        car.reset(options={"start": state})
        assert car.step(2)[1] == reward
        cars = mountain_car_v0.parallel_env(["a"], hill)
        cars.reset(options={"start": {"a": state}})
        assert cars.step({"a": 2})[1] == {"a": reward}
        assert there == Hill().step(state, 2)[0]


POSITIVE = [(name, bad) for name in ("omega", "mass", "time_step") for bad in (0.0, -1.0)]
NOT_NEGATIVE = [(name, -0.1) for name in ("gravity", "friction", "thrust")]
NUMBERS = [name for name in Hill._fields if name not in {"inelastic_wall", "integrator", "dynamics"}]
OUT_OF_ORDER = [
    ("max_position", -1.2),
    ("goal_position", -1.2),
    ("goal_position", 0.7),
    ("min_velocity", 0.01),
    ("max_velocity", 0.0),
    ("min_start", -1.3),
    ("min_start", 0.51),
    ("max_start", -0.7),
    ("max_start", 0.51),
]
NOT_FINITE = [(name, bad) for name in NUMBERS for bad in (math.nan, math.inf, -math.inf)]
NO_NUMBERS = [(name, bad) for name in NUMBERS for bad in ("1", None, True, 1j)]
NO_CHOICE = [(name, bad) for name in ("integrator", "dynamics") for bad in ("euler", 2, None)]
NO_TRUTH = [("inelastic_wall", 1), ("inelastic_wall", "yes"), ("inelastic_wall", None)]


@pytest.mark.parametrize("build", [Hill, Hill()._replace])
@pytest.mark.parametrize(
    ("error", "name", "bad"),
    [(ValueError, *case) for case in POSITIVE + NOT_NEGATIVE + OUT_OF_ORDER + NOT_FINITE + NO_CHOICE]
    + [(TypeError, *case) for case in NO_NUMBERS + NO_TRUTH],
)
def test_bad_constant_is_refused_by_name_and_value(
    build: Any, error: type[Exception], name: str, bad: object
) -> None:
    with pytest.raises(error, match=rf"^{name} must be .*, got {re.escape(repr(bad))}$"):
        build(**{name: bad})


@pytest.mark.parametrize("chosen", [*Integrator, *Dynamics])
def test_choices_may_be_given_by_their_names(chosen: Integrator | Dynamics) -> None:
    field = type(chosen).__name__.lower()
    named: dict[str, Any] = {field: chosen.label}
    assert getattr(Hill(**named), field) is chosen
    assert Hill(**named) == Hill()._replace(**{field: chosen})


def test_misspelt_integrator_is_told_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean 'explicit'"):
        Hill(integrator="explict")


@pytest.mark.parametrize("name", HILLS)
def test_hill_survives_pickling(name: str) -> None:
    copy = pickle.loads(pickle.dumps(HILLS[name]))  # noqa: S301 (our own bytes)
    assert copy == HILLS[name]
    assert [type(constant) for constant in copy] == [type(constant) for constant in HILLS[name]]
    assert isinstance(copy, Hill)

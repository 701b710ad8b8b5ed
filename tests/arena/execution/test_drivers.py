"""Two drivers, one result: the same bits whatever drives, however many workers, whoever else races."""

from typing import Any

import joblib
import numpy as np
import pytest
from bits import bits_of
from hand_made_agents import Leaky, race_of
from hypothesis import given, settings
from hypothesis import strategies as st

from agents import HarmonicRate, LinearDecay, QLearning, Sarsa
from agents.registry import BUILT_IN
from arena import Entrant, Evaluation, Tournament, Training, run
from arena.tournament.readings import READINGS
from envs import Hill

HILLS = {
    "default": Hill(),
    "friction": Hill(friction=20.0, thrust=1.5),
    "explicit": Hill(integrator="explicit"),
    "steeper": Hill(omega=3.3, mass=900.0, min_position=-1.1, time_step=1.2),
    "elastic": Hill(inelastic_wall=False, min_position=-0.9),
}


@pytest.mark.parametrize("hill", HILLS.values(), ids=HILLS)
@pytest.mark.parametrize("seed", [0, 12345])
def test_both_drivers_get_the_same_bits_on_every_hill(hill: Hill, seed: int) -> None:
    entrants = [Entrant(name, BUILT_IN[name]) for name in ("q-learning", "sarsa", "random", "momentum")]
    tournament = Tournament(
        (*entrants, Entrant("allocates", Leaky)),
        hill,
        Training(episodes=5, max_steps=300),
        Evaluation(episodes=5, max_steps=200),
        replicates=2,
        seed=seed,
    )
    with (
        run(tournament, n_jobs=1, driver="compiled") as compiled,
        run(tournament, n_jobs=1, driver="pettingzoo") as interpreted,
    ):
        assert set(compiled.frame().driver) == {"compiled"}
        assert set(interpreted.frame().driver) == {"pettingzoo"}
        assert bits_of(compiled) == bits_of(interpreted)
        assert {"values", "visits", "lengths"} <= compiled.arrays("sarsa").keys()


@pytest.mark.parametrize("reading", READINGS)
def test_every_reading_gets_the_same_bits_from_both_drivers(reading: str) -> None:
    entrants = (Entrant("q", QLearning, bins=4), Entrant("s", Sarsa, bins=5))
    training = Training(episodes=4, max_steps=400)
    tournament = Tournament(
        entrants, training=training, evaluation=Evaluation(4, 100), replicates=1, reading=reading
    )
    with (
        run(tournament, n_jobs=1, driver="compiled") as compiled,
        run(tournament, n_jobs=1, driver="pettingzoo") as interpreted,
    ):
        assert bits_of(compiled) == bits_of(interpreted)


@settings(max_examples=15, deadline=None)
@given(
    seed=st.integers(0, 2**40),
    bins=st.tuples(st.integers(1, 12), st.integers(1, 12)),
    discount=st.floats(0, 1),
    epsilon=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    rate=st.tuples(st.floats(0.1, 1), st.floats(1, 10), st.floats(0, 1)),
    algorithm=st.sampled_from([QLearning, Sarsa]),
)
def test_both_drivers_agree_whatever_the_parameters(
    seed: int,
    bins: tuple[int, int],
    discount: float,
    epsilon: tuple[float, float],
    rate: tuple[float, float, float],
    algorithm: type[Any],
) -> None:
    parameters = {"epsilon": LinearDecay(*epsilon), "step_size": HarmonicRate(*rate)}
    entrant = Entrant("any", algorithm, bins=bins, discount=discount, **parameters)
    tournament = race_of(entrant, seed=seed)
    with (
        run(tournament, n_jobs=1, driver="compiled") as compiled,
        run(tournament, n_jobs=1, driver="pettingzoo") as interpreted,
    ):
        assert bits_of(compiled) == bits_of(interpreted)


@pytest.mark.parametrize("driver", ["compiled", "pettingzoo"])
@pytest.mark.parametrize("backend", ["loky", "threading"])
def test_workers_and_backends_change_no_bit(small: Tournament, driver: str, backend: str) -> None:
    with run(small, n_jobs=1, driver=driver) as alone:
        expected = bits_of(alone)
    with joblib.parallel_config(backend=backend), run(small, n_jobs=2, driver=driver) as together:
        assert bits_of(together) == expected


@pytest.mark.parametrize("driver", ["compiled", "pettingzoo"])
def test_other_entrants_and_their_order_change_no_bit(small: Tournament, driver: str) -> None:
    q, s = small.entrants
    with run(small, n_jobs=1, driver=driver) as both:
        expected = bits_of(both)[1]
    for entrants in ((s, q), (q,), (Entrant("new", Leaky), s)):
        with run(race_of(*entrants), n_jobs=1, driver=driver) as others:
            found = bits_of(others)[1]
        assert {key: found[key] for key in found if key in expected} == {
            key: expected[key] for key in found if key in expected
        }


def test_replicates_and_entrants_are_independent(small: Tournament) -> None:
    twin = Entrant("twin", QLearning, bins=(5, 6))
    with run(race_of(*small.entrants, twin), n_jobs=1) as results:
        visits = [results.arrays(*key)["visits"] for key in (("q", 0), ("q", 1), ("twin", 0))]
    assert not np.array_equal(visits[0], visits[1])
    assert not np.array_equal(visits[0], visits[2])


def test_all_entrants_are_tested_from_the_same_starts(small: Tournament) -> None:
    starts = small.conditions.start_states(0)
    assert starts.shape == (5, 2)
    assert np.all((starts[:, 0] >= -0.6) & (starts[:, 0] < -0.4) & (starts[:, 1] == 0.0))
    assert not np.array_equal(starts, small.conditions.start_states(1))


def test_training_learns_to_drive() -> None:
    entrants = tuple(Entrant(name, BUILT_IN[name], bins=(20, 20)) for name in ("q-learning", "sarsa"))
    with run(Tournament(entrants, replicates=2, evaluation=Evaluation(200)), n_jobs=2) as results:
        frame = results.frame()
    assert frame.accuracy.mean() > 80.0
    assert frame.mean_length.between(97.0, 250.0).all()
    assert frame.iterations.between(900_000, 1_300_000).all()

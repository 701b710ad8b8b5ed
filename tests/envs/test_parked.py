"""Cars that have ended stay."""

import pytest

from envs.mountain_car_v0 import parallel_env
from envs.parked import FLAGS, Parked

START = {"start": {"car_0": (0.45, 0.06), "car_2": (0.3, 0.06)}}  # there after 1 and 4 steps to the right


@pytest.mark.parametrize("flags", FLAGS)
def test_all_cars_are_told_of_until_all_have_ended(flags: str) -> None:
    parked, plain = Parked(parallel_env(3, max_steps=6), flags), parallel_env(3, max_steps=6)
    for _ in range(2):
        seen, _ = parked.reset(seed=1, options=START)
        last = plain.reset(seed=1, options=START)[0]
        for step in range(6):
            assert parked.agents == ["car_0", "car_1", "car_2"]
            live = list(plain.agents)
            seen, rewards, *_, infos = parked.step(dict.fromkeys(parked.agents, 2))
            last |= plain.step(dict.fromkeys(live, 2))[0]
            assert {car: value.tolist() for car, value in seen.items()} == {
                car: value.tolist() for car, value in last.items()
            }
            assert rewards == {car: -1.0 if car in live else 0.0 for car in last}
            assert list(infos) == list(last)
            assert parked.agents == ([] if step == 5 else list(last))
        assert parked.step({}) == ({}, {}, {}, {}, {})


def told(flags: str, cars: int, steps: int) -> list[tuple[list[bool], list[bool]]]:
    parked = Parked(parallel_env(cars, max_steps=steps), flags)
    parked.reset(
        options={"start": {car: START["start"].get(car, (-0.5, 0.0)) for car in parked.possible_agents}}
    )
    answers = []
    while parked.agents:
        _, _, terminated, truncated, _ = parked.step(dict.fromkeys(parked.agents, 2))
        answers.append((list(terminated.values()), list(truncated.values())))
    return answers


def test_flags_are_kept_from_the_end_of_each_car_on() -> None:
    assert told("kept", 2, 3) == [
        ([True, False], [False, False]),
        ([True, False], [False, False]),
        ([True, False], [False, True]),
    ]


def test_flags_are_told_together_as_truncation_if_any_was() -> None:
    assert told("together", 2, 3) == [([False] * 2, [False] * 2)] * 2 + [([False] * 2, [True] * 2)]
    assert told("together", 1, 3) == [([True], [False])]


def test_what_a_client_changes_in_an_observation_stays_its_own() -> None:
    parked = Parked(parallel_env(2))
    first = parked.reset(options={"start": {"car_0": (0.45, 0.06)}})[0]
    first["car_0"][:] = 7.0
    seen = parked.step({"car_0": 2, "car_1": 2})[0]
    place = seen["car_0"].tolist()
    seen["car_0"][:] = 7.0
    assert parked.step({"car_0": 2, "car_1": 2})[0]["car_0"].tolist() == place


def test_other_flags_are_refused() -> None:
    with pytest.raises(ValueError, match=r"flags must be .*'never'"):
        Parked(parallel_env(), "never")


def test_a_missing_action_is_told_as_without_it() -> None:
    parked = Parked(parallel_env(2))
    parked.reset(seed=1)
    with pytest.raises(ValueError, match="actions must have one for each live car, got none for 'car_1'"):
        parked.step({"car_0": 2})

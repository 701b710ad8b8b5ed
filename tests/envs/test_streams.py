import os
import subprocess
import sys

import numpy as np
import pytest

from envs.foundation.streams import stable_hash, stream

KNOWN = {
    "": 0xB4B2_7974_57A0_A6E4,
    "start": 0xF709_1535_421F_26A0,
    "car_0": 0xA433_73E4_2976_D3D6,
    "Größe ∆": 0xB12D_1D2C_9F7C_0E18,
}


@pytest.mark.parametrize(("text", "known"), KNOWN.items())
def test_hash_is_the_same_for_ever(text: str, known: int) -> None:
    assert stable_hash(text) == known


def draws(seed: int | np.random.SeedSequence, purpose: str, identity: str = "") -> tuple[float, ...]:
    return tuple(stream(seed, purpose, identity).random(4).tolist())


def test_stream_is_the_same_for_ever() -> None:
    assert draws(7, "start", "car_0")[0] == 0.0781208623922206


def test_equal_seed_purpose_and_identity_give_equal_streams() -> None:
    assert draws(7, "start", "car_0") == draws(7, "start", "car_0")
    assert draws(np.random.SeedSequence(7), "start", "car_0") == draws(7, "start", "car_0")


def test_seeds_purposes_and_identities_each_give_streams_of_their_own() -> None:
    named = [(p, i) for p in ("start", "train", "") for i in ("car_0", "car_1", "start", "train", "")]
    keys = [(seed, *key) for seed in (0, 1, 2**40) for key in named]
    assert len({draws(*key) for key in keys}) == len(keys)


def test_streams_do_not_advance_each_other() -> None:
    one, other = stream(7, "start", "car_0"), stream(7, "start", "car_1")
    taken = [(one.random(), other.random()) for _ in range(4)]
    assert tuple(first for first, _ in taken) == draws(7, "start", "car_0")
    assert tuple(second for _, second in taken) == draws(7, "start", "car_1")


@pytest.mark.parametrize("salt", ["1", "2"])
def test_streams_are_the_same_in_every_process(salt: str) -> None:
    program = (
        "from envs.foundation.streams import *; "
        "print(stable_hash('car_0'), stream(7, 'start', 'car_0').random())"
    )
    found = subprocess.check_output(
        [sys.executable, "-c", program], env={**os.environ, "PYTHONHASHSEED": salt}, text=True
    )
    assert found.split() == [str(stable_hash("car_0")), str(draws(7, "start", "car_0")[0])]

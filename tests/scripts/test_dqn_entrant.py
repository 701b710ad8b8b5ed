"""A deep agent that is not ours, Stable-Baselines3's DQN, keeps all the rules of an entrant."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bits import bits_of
from paths import ROOT

from agents import QLearning
from arena import Entrant, Evaluation, Tournament, Training, load_plugin, run
from arena.testing import findings
from envs import Hill

pytest.importorskip("stable_baselines3", reason="Stable-Baselines3, and PyTorch with it, is not installed")
pytestmark = pytest.mark.docs

SCRIPT = ROOT / "scripts" / "dqn_entrant.py"
SMALL = {"width": 16, "batch_size": 16, "learning_starts": 50, "train_every": 8, "gradient_steps": 2}


@pytest.fixture
def agent(isolated_registry: None) -> Any:
    """The class, loaded as a plugin."""
    return load_plugin(SCRIPT)["sb3-dqn"]


def test_it_holds_to_the_contract(agent: Any) -> None:
    found = {one.check: one for one in findings(Entrant("dqn", agent, **SMALL))}
    assert [f"{name}: {one.reason}" for name, one in found.items() if one.status == "failed"] == []
    assert found["same seed same bits"].status == "ok"
    assert found["independent of others"].status == "ok"


def test_two_workers_get_the_bits_of_one_process_and_keep_the_weights(agent: Any) -> None:
    tournament = Tournament(
        (Entrant("dqn", agent, **SMALL), Entrant("q", QLearning, bins=5)),
        training=Training(episodes=4, max_steps=100),
        evaluation=Evaluation(episodes=5, max_steps=100),
        replicates=2,
    )
    with run(tournament, n_jobs=2) as results:
        assert {one["status"] for one in results.runs} == {"finished"}
        arrays = [results.arrays("dqn", replicate) for replicate in (0, 1)]
        expected = bits_of(results)
    assert arrays[0]["q_net_0_weight"].shape == (16, 2)
    assert not np.array_equal(arrays[0]["q_net_0_weight"], arrays[1]["q_net_0_weight"])
    with run(tournament, n_jobs=1) as results:
        assert bits_of(results) == expected


def test_it_learns_which_action_is_rewarded(agent: Any) -> None:
    hill, rng = Hill(), np.random.default_rng(1)
    made = agent.create(hill, **SMALL | {"gradient_steps": 10}, rng=rng)
    before = made.q_net_0_weight.copy()
    for _ in range(1000):
        observation = rng.uniform(hill.low, hill.high)
        action = int(rng.integers(3))
        # Left is right on the left, right on the right.
        reward = float(action == (0 if observation[0] < -0.3 else 2))
        made.learn(observation, action, reward, observation, 0, terminated=True)
    assert not np.array_equal(made.q_net_0_weight, before)  # they are the network's own memory
    assert made.greedy(np.array([-1.0, 0.0])) == 0
    assert made.greedy(np.array([0.4, 0.0])) == 2


def test_the_script_prints_the_table(tmp_path: Path) -> None:
    command = [sys.executable, str(SCRIPT), "--episodes", "6", "--replicates", "2", "--jobs", "2"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=570, check=False)
    assert done.returncode == 0, done.stderr
    rows = [line.split()[:3] for line in done.stdout.splitlines()[1:]]
    assert rows == [
        ["sb3-dqn", "0", "pettingzoo"],
        ["sb3-dqn", "1", "pettingzoo"],
        ["q-learning", "0", "compiled"],
        ["q-learning", "1", "compiled"],
    ]

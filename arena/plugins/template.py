"""What ``arena new-agent`` writes: an agent that runs at once, and its test."""

import keyword
import re
from importlib.util import find_spec
from pathlib import Path

from agents.registry import all_agents
from arena.plugins.loading import kebab
from envs.foundation.errors import InvalidValueError

AGENT = '''"""{title}: say here where the algorithm comes from."""

from typing import NamedTuple

import numpy as np

from agents import Grid
from agents.parameters import Probability, StepSize


class {class_name}(NamedTuple):
    """Learns, in each cell of a grid, the value of each action from what followed it.

    A named tuple of numbers and arrays with plain methods is compiled by the arena if the methods keep
    to numbers, loops and array elements. What changes lives in arrays.
    """

    grid: Grid
    values: np.ndarray
    step_size: float
    epsilon: float

    # The keyword-only arguments are the parameters: for scripts, TOML files and sweeps alike. ``task``
    # is the hill: task.low, task.high, task.n_actions. An argument ``rng`` would get a generator.
    @classmethod
    def create(cls, task, *, bins=(20, 20), step_size: StepSize = 0.2, epsilon: Probability = 0.1):
        grid = Grid.over(task, bins)
        return cls(grid, np.zeros((grid.size, task.n_actions)), step_size, epsilon)

    # How it drives while it learns. ``progress`` in [0, 1) is the share of the training that is done.
    # All chance must come from ``rng``.
    def act(self, observation, progress, rng):
        if rng.random() < self.epsilon * (1.0 - progress):
            return int(rng.random() * self.values.shape[1])
        return self.greedy(observation)

    # One transition; ``terminated`` says that the goal was reached. A time limit does not terminate. The
    # next action is chosen after this; an argument ``next_action`` before ``terminated`` would be told it
    # before this, as SARSA wants it.
    def learn(self, observation, action, reward, next_observation, terminated):
        cell = self.grid.encode(observation)
        target = reward
        if not terminated:
            target += self.values[self.grid.encode(next_observation), self.greedy(next_observation)]
        self.values[cell, action] += self.step_size * (target - self.values[cell, action])

    # How it drives when it is tested.
    def greedy(self, observation):
        cell = self.grid.encode(observation)
        best = 0
        for action in range(1, self.values.shape[1]):
            if self.values[cell, action] > self.values[cell, best]:
                best = action
        return best
'''

TEST = '''"""The contract of the arena, for {class_name}: run with pytest."""

from pathlib import Path

from arena import Entrant, load_plugin
from arena.testing import parametrize_with_checks

AGENTS = load_plugin(Path(__file__).with_name("{module}.py"))


@parametrize_with_checks([Entrant(name, agent) for name, agent in AGENTS.items()])
def test_contract(entrant, check):
    check(entrant)
'''


def write(name: str, folder: Path) -> tuple[Path, Path]:
    """Write the files of the agent ``name``; those that are there already are left alone.

    Args:
        name: letters, digits and dashes, such as ``my-agent``; what its class will be called.
        folder: is made if it is not there.

    Raises:
        ValueError: when the name is bad or taken, or a file is there already.
    """
    if not re.fullmatch("[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        raise InvalidValueError(
            f"NAME must be lower-case words joined by dashes, such as my-agent, got {name!r}"
        )
    words = name.split("-")
    class_name, module = "".join(map(str.capitalize, words)), "_".join(words)
    called = kebab(class_name)
    if called != name:  # single letters and numbers run together
        raise InvalidValueError(
            f"NAME must be what its class is called, which for {class_name} is {called}, got {name!r}"
        )
    files = folder / f"{module}.py", folder / f"test_{module}.py"
    for path in files:
        if path.exists():
            raise InvalidValueError(f"{path} is there already")
    if name in all_agents()[0] or find_spec(module):
        raise InvalidValueError(f"NAME must not be that of another agent or of a Python module, got {name!r}")
    if keyword.iskeyword(class_name) or re.search(rf"import .*\b{class_name}\b", AGENT):
        raise InvalidValueError(f"NAME must not be that of a class which the agent needs, got {name!r}")
    parts = {"title": " ".join(words).capitalize(), "class_name": class_name, "module": module}
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in zip(files, (AGENT, TEST), strict=True):
        path.write_text(text.format(**parts), encoding="utf-8")
    return files

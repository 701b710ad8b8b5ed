"""What the documentation of 0.1 told people to import still imports, and says where it is now."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from fresh import output_of

import arena
from arena import deprecated

DOCUMENTED = """
from arena.configuration import from_dict
from arena.configuration import load_tournament
from arena.curves import area, learning_curves, moving_average, settled
from arena.figures_policy import draw_phase, draw_policy
from arena.leaderboard import leaderboard
from arena.pairs import compare_entrants
from arena.trained import trained
""".strip().splitlines()  # pages of results, docs/gallery.md, docs/statistics.md

STILL = """
import envs
from agents import Grid, MomentumAgent, QLearning, Sarsa
from agents.optimal import optimal_steps
from agents.parameters import Count, Positive, Probability
from arena import Entrant, Evaluation, PolicyAgent, Tournament, Training, load, load_plugin, quick
from arena import random_walk, run
from arena.results import Results, load
from arena.testing import check_agent, parametrize_with_checks
from arena.tournament import Evaluation, Tournament, Training
from envs import Hill, mountain_car_v0
from envs.compilation import compile_loop
from envs.mountain_car_v0 import parallel_env
from envs.parked import Parked
from envs.single_car_v0 import SingleCarEnv
from envs.vector_car_v0 import VectorCarEnv
"""


@pytest.mark.parametrize("line", DOCUMENTED)
def test_what_has_moved_imports_and_warns(line: str) -> None:
    old = line.split()[1]
    new, _ = deprecated.MOVED[old]
    sys.modules.pop(old, None)
    names: dict[str, Any] = {}
    with pytest.warns(
        DeprecationWarning, match=rf"^{old} goes in version 0\.3; its names are in {new}: "
    ) as caught:
        exec(line, names)  # noqa: S102 (our own)
    (warning,) = caught
    assert warning.filename == "<string>"  # the line itself, not the machinery of imports
    for name in line.partition(" import ")[2].split(", "):
        place = arena.Results if name == "trained" else import_module(new)
        assert names[name] is getattr(place, name)


def test_what_has_not_moved_imports_without_a_warning() -> None:
    output_of(f"import warnings\nwarnings.simplefilter('error', DeprecationWarning)\n{STILL}")


@pytest.mark.parametrize("old", deprecated.MOVED)
def test_a_module_that_has_moved_is_an_attribute_once_it_is_imported(old: str) -> None:
    code = f"import sys, arena; assert {old!r} not in sys.modules; import {old}; print({old}.__name__)"
    assert output_of(code) == f"{old}\n"


def test_no_module_that_has_moved_hides_another_or_a_public_name() -> None:
    for old in deprecated.MOVED:
        package, _, name = old.rpartition(".")
        assert package == "arena"
        assert name not in arena.__all__
        assert not list(Path(arena.__path__[0]).glob(f"{name}*")), "there is such a module"


def test_a_script_is_told_without_any_option(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("from arena.leaderboard import leaderboard\n")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert f"{script}:1: DeprecationWarning: arena.leaderboard goes in version 0.3" in done.stderr

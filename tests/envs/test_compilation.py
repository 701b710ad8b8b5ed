"""Plain methods compiled: never stale, never confused, cached across processes."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from paths import ROOT

from agents import QLearning, Sarsa
from envs import Hill
from envs.compilation import CompilationError, compile_loop, entry_point, kernel_info
from envs.compilation.reachable import ReachableCode

PLUGIN = """
from typing import NamedTuple
import numpy as np
from helper import answer, FACTOR

class Part(NamedTuple):
    x: float
    def times(self, y):
        return self.x * y

class Plugin(NamedTuple):
    part: Part
    def value(self):
        return self.part.times(answer()) * FACTOR

def loop(plugin):
    return plugin.value()
"""

ASK = """
import os
import numba.core.caching as caching
hits = []
load = caching.Cache.load_overload
caching.Cache.load_overload = lambda self, *a: hits.append(load(self, *a)) or hits[-1]
from envs.compilation import compile_loop
from plugin import Part, Plugin, loop
plugin = Plugin(Part(2.0))
print(compile_loop(loop, plugin)(plugin), "cached" if any(hits) else "compiled")
"""


def ask(folder: Path) -> str:
    """What a new process computes with the plugin in ``folder``."""
    path = os.pathsep.join([str(folder), str(ROOT)])
    environment = os.environ | {"PYTHONPATH": path, "ARENA_CACHE_DIR": str(folder / "kernels")}
    done = subprocess.run(
        [sys.executable, "-c", ASK], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


@pytest.mark.system
def test_kernels_are_cached_across_processes_and_never_stale_after_an_edit_anywhere(tmp_path: Path) -> None:
    plugin, helper = tmp_path / "plugin.py", tmp_path / "helper.py"
    plugin.write_text(PLUGIN)
    helper.write_text("FACTOR = 1.0\ndef answer():\n    return 3.0\n")
    assert ask(tmp_path) == "6.0 compiled"
    assert ask(tmp_path) == "6.0 cached"
    helper.write_text("FACTOR = 1.0\ndef answer():\n    return 4.0\n")  # a function of another module
    assert ask(tmp_path) == "8.0 compiled"
    helper.write_text("FACTOR = 2.0\ndef answer():\n    return 4.0\n")  # a constant of another module
    assert ask(tmp_path) == "16.0 compiled"
    plugin.write_text(PLUGIN.replace("self.x * y", "self.x + y"))  # a method of a part
    assert ask(tmp_path) == "12.0 compiled"
    plugin.write_text(PLUGIN)
    assert ask(tmp_path) == "16.0 cached"  # the older code is still there, under its own fingerprint


def test_without_a_writable_cache_it_compiles_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "plugin.py").write_text(PLUGIN)
    (tmp_path / "helper.py").write_text("FACTOR = 1.0\ndef answer():\n    return 3.0\n")
    (tmp_path / "kernels").write_text("a file, where a folder should be")
    assert ask(tmp_path) == "6.0 compiled"


class One(NamedTuple):
    x: float

    def same_name(self, a: float) -> float:
        return self.x + a


class Other(NamedTuple):
    y: float

    def same_name(self, a: float, b: float = 2.0) -> float:
        return self.y * a * b


def call_both(one: One, other: Other) -> tuple[float, float, float]:
    return one.same_name(1.0), other.same_name(1.0), other.same_name(1.0, b=5.0)


def test_methods_of_one_name_in_different_classes_keep_their_own_signatures() -> None:
    arguments = (One(10.0), Other(3.0))
    assert compile_loop(call_both, *arguments)(*arguments) == (11.0, 6.0, 15.0)


def call_missing(one: One) -> float:
    return one.missing()  # type: ignore[attr-defined, no-any-return]


def test_what_cannot_be_compiled_is_told_in_one_line() -> None:
    with pytest.raises(CompilationError, match=r"^Unknown attribute 'missing' of type One\(float64 x 1\)$"):
        compile_loop(call_missing, One(1.0))


def make_class(factor: float) -> Any:
    class Redefined(NamedTuple):
        x: float

        def value(self) -> float:
            return self.x * factor

    return Redefined


def call_value(thing: Any) -> float:
    return thing.value()  # type: ignore[no-any-return]


def test_a_class_that_is_defined_anew_as_in_a_notebook_is_not_mistaken_for_the_old_one() -> None:
    for factor in (2.0, 3.0):
        thing = make_class(factor)(1.0)
        assert compile_loop(call_value, thing)(thing) == factor


class Holder(NamedTuple):
    thing: Any
    factor: float


def call_held(holder: Holder) -> float:
    return holder.factor * holder.thing.value()  # type: ignore[no-any-return]


@pytest.mark.parametrize("hand_out", [compile_loop, entry_point])
def test_another_object_of_the_same_class_as_workers_unpickle_it_runs_the_same_code(hand_out: Any) -> None:
    for factor in (2.5, 3.5, 2.5):  # after each edit, twice
        for _ in range(2):
            holder = Holder(make_class(factor)(2.0), 10.0)
            assert hand_out(call_held, holder)(holder) == call_held(holder) == 20.0 * factor


def test_with_numbas_switch_for_debugging_the_loop_itself_is_returned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("numba.config.DISABLE_JIT", 1)
    assert compile_loop(call_both, One(1.0), Other(1.0)) is call_both
    for what in (kernel_info, entry_point):
        with pytest.raises(CompilationError, match=r"^NUMBA_DISABLE_JIT is set$"):
            what(call_both, One(1.0), Other(1.0))


def test_numbas_own_cache_folder_is_left_as_it_was() -> None:
    from numba.core import config

    before = config.CACHE_DIR
    compile_loop(call_both, One(1.0), Other(1.0))
    assert before == config.CACHE_DIR


def test_fingerprints_tell_agents_and_types_apart_but_not_values() -> None:
    hill = Hill()

    def mark(agent: Any) -> str:
        return ReachableCode(call_value, hill, agent).fingerprint()

    assert mark(QLearning.create(hill)) == mark(QLearning.create(hill, bins=(7, 9), discount=0.5))
    assert mark(QLearning.create(hill)) != mark(Sarsa.create(hill))
    assert mark(QLearning.create(hill)) != mark(QLearning.create(hill, binning="quantile"))
    single = QLearning.create(hill)._replace(values=np.zeros((600, 3), np.float32))
    assert mark(QLearning.create(hill)) != mark(single)

"""Kernels on disk: whatever becomes of the files, a kernel is as fast and computes the same."""

import itertools
import json
import logging
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from paths import ROOT

from envs.compilation import compile_loop

ASK = """
import json, sys
import numba.core.caching as caching
hits = []
load = caching.Cache.load_overload
caching.Cache.load_overload = lambda self, *a: hits.append(load(self, *a)) or hits[-1]
import plugin
from envs.compilation import compile_loop, kernel_info
answers = {}
for name in sys.argv[1:]:
    loop, part = getattr(plugin, name), plugin.Part(2.0)
    hits.clear()
    value, info = compile_loop(loop, part)(part), kernel_info(loop, part)
    how = "cached" if any(hits) else "compiled"
    answers[name] = [value, "counted" if info.counts_references else "fast", how, info.fingerprint]
print(json.dumps(answers))
"""
PART = """
from typing import NamedTuple
import numpy as np

class Part(NamedTuple):
    x: float
    def value(self):
        return self.x * 3.0

"""
FAST = "def {}(part):\n    return part.value() + {}\n"
ALLOCATING = "def {}(part):\n    return np.full(2, part.value())[1] + {}\n"
LIMITED = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))\n"

Answers = dict[str, tuple[float, str, str]]


class Kernels:
    """Loops of a plugin, and a cache folder of their own."""

    def __init__(self, folder: Path, *names: str, template: str = FAST) -> None:
        self.home, self.cache, self.names = folder, folder / "kernels", names
        loops = [template.format(name, number) for number, name in enumerate(names)]
        (folder / "plugin.py").write_text(PART + "".join(loops))
        self.fingerprints: dict[str, str] = {}

    def start(self, code: str = ASK, **environment: str) -> subprocess.Popen[str]:
        """A new process that compiles all of them."""
        path = os.pathsep.join([str(self.home), str(ROOT)])
        environment |= {"PYTHONPATH": path, "ARENA_CACHE_DIR": str(self.cache)}
        command = [sys.executable, "-c", code, *self.names]
        pipe = subprocess.PIPE
        return subprocess.Popen(command, env=os.environ | environment, stdout=pipe, stderr=pipe, text=True)

    def finish(self, process: subprocess.Popen[str], warning: str = "") -> Answers:
        """What it says of each: the value computed, how fast it is, and where it is from."""
        out, err = process.communicate(timeout=120)
        assert (process.returncode, err.strip()) == (0, warning)
        answers = json.loads(out)
        self.fingerprints = {name: answer.pop() for name, answer in answers.items()}
        return {name: tuple(answer) for name, answer in answers.items()}

    def ask(self, warning: str = "", code: str = ASK, **environment: str) -> Answers:
        """The same of a new process."""
        return self.finish(self.start(code, **environment), warning)

    def expected(self, speed: str, how: str) -> Answers:
        """If all are alike."""
        return {name: (6.0 + number, speed, how) for number, name in enumerate(self.names)}

    def file(self, name: str) -> Path:
        """The only one of this loop."""
        (file,) = self.cache.glob(f"{self.fingerprints[name]}*")
        return file


def emptied(file: Path, _other: Path) -> None:
    file.write_bytes(b"")


def truncated(file: Path, _other: Path) -> None:
    file.write_bytes(file.read_bytes()[:-100])


def garbage(file: Path, _other: Path) -> None:
    file.write_bytes(os.urandom(5000))


def one_bit_wrong(file: Path, _other: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def of_another_kernel(file: Path, other: Path) -> None:
    shutil.copy(other, file)


def folder(file: Path, _other: Path) -> None:
    file.unlink()
    file.mkdir()
    (file / "something").write_text("in it")


def removed(file: Path, _other: Path) -> None:
    file.unlink()


def link_to_nowhere(file: Path, _other: Path) -> None:
    file.unlink()
    file.symlink_to("nowhere")


def queue(file: Path, _other: Path) -> None:
    file.unlink()
    os.mkfifo(file)


def unreadable(file: Path, _other: Path) -> None:
    file.chmod(0)


DAMAGES: list[Callable[[Path, Path], None]] = [
    *(emptied, truncated, garbage, one_bit_wrong, of_another_kernel, folder, removed),
    *((link_to_nowhere, queue) if os.name == "posix" else ()),
    *((unreadable,) if os.name == "posix" and os.geteuid() else ()),  # root can read all
]


@pytest.mark.system
@pytest.mark.parametrize(("template", "speed"), [(FAST, "fast"), (ALLOCATING, "counted")])
def test_a_damaged_kernel_is_compiled_anew_as_fast_and_replaced(
    template: str, speed: str, tmp_path: Path
) -> None:
    kernels = Kernels(tmp_path, "whole", *(damage.__name__ for damage in DAMAGES), template=template)
    assert kernels.ask() == kernels.expected(speed, "compiled")
    for damage in DAMAGES:
        damage(kernels.file(damage.__name__), kernels.file("whole"))
    whole = {"whole": (6.0, speed, "cached")}
    assert kernels.ask() == kernels.expected(speed, "compiled") | whole
    assert kernels.ask() == kernels.expected(speed, "cached")
    assert all(kernels.file(name).is_file() for name in kernels.names)


@pytest.mark.system
def test_kernels_of_another_processor_or_another_numba_are_left_alone(tmp_path: Path) -> None:
    kernels = Kernels(tmp_path, "loop")
    for how in ("compiled", "cached"):
        assert kernels.ask() == kernels.expected("fast", how)
        assert kernels.ask(NUMBA_CPU_NAME="generic") == kernels.expected("fast", how)
        other = "import numba; numba.__version__ = '0.0'\n" + ASK
        assert kernels.ask(code=other) == kernels.expected("fast", how)
    assert len([*kernels.cache.glob("*.nbc")]) == 3


@pytest.mark.system
def test_processes_that_compile_the_same_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    kernels = Kernels(tmp_path, "loop", "other")
    for process in [kernels.start() for _ in range(3)]:
        assert {answer[:2] for answer in kernels.finish(process).values()} == {(6.0, "fast"), (7.0, "fast")}
    assert kernels.ask() == kernels.expected("fast", "cached")
    assert sorted(path.suffix for path in kernels.cache.iterdir()) == ["", ".nbc", ".nbc"]  # and no halves


@pytest.mark.system
def test_if_nothing_can_be_written_it_is_said_once_and_what_is_there_is_used(tmp_path: Path) -> None:
    pytest.importorskip("resource")
    kernels = Kernels(tmp_path, "loop", "other")
    why = f"kernels are compiled anew each time, none is kept in {kernels.cache}: "
    assert kernels.ask(why + "File too large", LIMITED + ASK) == kernels.expected("fast", "compiled")
    assert [*kernels.cache.iterdir()] == []
    assert kernels.ask() == kernels.expected("fast", "compiled")
    assert kernels.ask("", LIMITED + ASK) == kernels.expected("fast", "cached")
    shutil.rmtree(kernels.cache)
    kernels.cache.write_text("a file, where a folder should be")
    assert kernels.ask(why + "Not a directory") == kernels.expected("fast", "compiled")


@pytest.mark.system
def test_workers_leave_it_to_the_command_to_say_that_nothing_can_be_written(tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file, where a folder should be")
    entrants = "".join(f'[[entrants]]\nagent = "momentum"\nname = "{name}"\n' for name in "abcd")
    limits = "[training]\nepisodes = 3\nmax_steps = 50\n[evaluation]\nepisodes = 2\nmax_steps = 50\n"
    (tmp_path / "race.toml").write_text(limits + entrants)
    environment = os.environ | {"PYTHONPATH": str(ROOT), "ARENA_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, "-m", "arena", "run", "race.toml", "--jobs", "2", "--no-report"]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0
    (line,) = done.stderr.splitlines()
    assert line.startswith("kernels are compiled anew each time, none is kept in ")


@pytest.mark.system
def test_a_use_is_recorded(tmp_path: Path) -> None:
    kernels = Kernels(tmp_path, "loop")
    kernels.ask()
    file = kernels.file("loop")
    os.utime(file, (1e9, 1e9))
    assert kernels.ask() == kernels.expected("fast", "cached")
    assert time.time() - file.stat().st_mtime < 100


class Part(NamedTuple):
    """What the loops below are compiled for, each time for another type."""

    x: Any


def first(part: Part) -> Any:
    return part.x[0]


def compile_something(length: int) -> None:
    """Compile what has not been compiled before in this process, if the length is new."""
    parts = Part((1.0,) * length)
    assert compile_loop(first, parts)(parts) == 1.0


def test_the_folder_is_swept_when_something_is_compiled_but_once_a_day(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ARENA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("envs.compilation.kernel_folder._PATIENCE", 60.0)
    mark = "0123456789abcdef" * 2
    months_old = [tmp_path / name for name in (f"{mark}.cafe.nbc", f"{mark}.cafe.nbc.half", "notes.nbc")]
    folder = tmp_path / f"{mark}-counted"  # as 0.1 left them
    recent = tmp_path / f"{mark}.beef.nbc"

    def fill() -> None:
        (folder / "arena").mkdir(parents=True, exist_ok=True)
        for file in (*months_old, recent, folder / "arena" / "train.nbi"):
            file.write_text("...")
        for path in (*months_old, folder):
            os.utime(path, (time.time() - 31 * 86400,) * 2)

    def kernels() -> list[Path]:
        return sorted(path for path in tmp_path.iterdir() if path.name.startswith(mark))

    fill()
    compile_something(11)
    assert kernels() == [recent]
    assert (tmp_path / "notes.nbc").exists()  # none of ours
    fill()
    everything = kernels()
    compile_something(12)
    assert kernels() == everything
    os.utime(tmp_path / "swept", (time.time() - 2 * 86400,) * 2)
    compile_something(13)
    assert kernels() == [recent]


def test_sweeping_ends_when_its_time_is_over_and_goes_on_at_the_next_compilation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ARENA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("envs.compilation.kernel_folder._PATIENCE", 0.0)
    old = {tmp_path / f"{number:032x}.cafe.nbc" for number in range(40)}
    for path in old:
        path.write_text("...")
        os.utime(path, (1e9, 1e9))
    swept = [0]
    for number in range(6):
        compile_something(20 + number)  # one is looked at each time, any of the old and the new
        swept.append(sum(not path.exists() for path in old))
    assert all(0 <= after - before <= 1 for before, after in itertools.pairwise(swept))
    assert swept[-1] > 0


def test_nothing_is_said_of_a_folder_that_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    for number, place in enumerate((tmp_path / "new" / "one", Path(f"{tmp_path}/new/another"))):
        monkeypatch.setenv("ARENA_CACHE_DIR", str(place))
        with caplog.at_level(logging.WARNING):
            compile_something(14 + number)
        assert caplog.messages == []
        assert len([*place.glob("*.nbc")]) == 1

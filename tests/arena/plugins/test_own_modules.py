"""Which modules of the user's own an agent's module uses."""

import importlib
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from arena import load_plugin
from arena.plugins.source_modules import own_modules

AGENTS = """
import os, sys
import numpy as np
from typing import (Any,
    NamedTuple)
from .helpers import (  # what they share
    one,
    two as second,
)
from . import values, absent
if True:
    import mine_package.lazy.deep as deep

def later():
    from mine_package.late import thing
"""
TEXTS = {
    "mine_package/__init__.py": "import mine_beside",
    "mine_package/agents.py": AGENTS,
    "mine_package/helpers/__init__.py": "from .one import one\ntwo = 2",
    "mine_package/helpers/one.py": "from ..values import VALUE as one",
    "mine_package/values.py": "from mine_package.constants import *\nVALUE = 1",
    "mine_package/constants.py": "import mine_package.values",
    "mine_package/lazy/__init__.py": "",
    "mine_package/lazy/deep.py": "",
    "mine_package/late.py": "",
    "mine_package/unused.py": "",
    "mine_package/absent.py": "",
    "mine_beside.py": "import mine_other, json\n",
    "mine_other.py": "from mine_package import values\n",
    "mine_unused.py": "",
}


@pytest.fixture(autouse=True)
def texts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with modules that can be imported."""
    for name, text in TEXTS.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    yield tmp_path
    for name in [name for name in sys.modules if name.startswith("mine_")]:
        del sys.modules[name]


def used(module: ModuleType) -> set[str]:
    """The names, whose files must be theirs."""
    found = own_modules(module)
    for name, file in found.items():
        assert file in (Path(f"{stem}{end}") for stem in [_stem(name)] for end in (".py", "/__init__.py"))
    return set(found)


def _stem(name: str) -> Path:
    return Path(sys.path[0]).resolve() / name.replace(".", "/")


def test_a_module_of_a_package_uses_what_it_imports_of_its_package() -> None:
    assert used(importlib.import_module("mine_package.agents")) == {
        f"mine_package.{name}"
        for name in ("agents", "helpers", "helpers.one", "values", "constants", "lazy.deep", "late", "absent")
    } | {"mine_package"}


def test_a_package_itself_is_in_its_package() -> None:
    assert used(importlib.import_module("mine_package")) == {"mine_package"}
    assert used(importlib.import_module("mine_package.helpers")) == {
        f"mine_package.{name}" for name in ("helpers", "helpers.one", "values", "constants")
    }


def test_a_module_in_no_package_uses_what_is_in_its_folder() -> None:
    assert used(importlib.import_module("mine_beside")) == {
        *("mine_beside", "mine_other", "mine_package", "mine_package.values", "mine_package.constants")
    }


def test_a_module_among_installed_ones_uses_none(texts: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (texts / "some_package-1.dist-info").mkdir()
    assert used(importlib.import_module("mine_beside")) == set()
    assert "mine_package.values" in used(importlib.import_module("mine_package.agents"))
    assert own_modules(textwrap) == {}
    folder = texts / "site-packages"
    folder.mkdir()
    (folder / "mine_installed.py").write_text("import mine_also_installed")
    (folder / "mine_also_installed.py").write_text("")
    monkeypatch.syspath_prepend(str(folder))
    assert used(importlib.import_module("mine_installed")) == set()


def test_a_plugin_uses_what_is_in_its_folder_but_not_itself(texts: Path) -> None:
    method = "lambda self, *_: 1"
    (texts / "driver.py").write_text(
        "import json\nimport numpy as np\nfrom mine_package.helpers import one\nimport mine_other as other\n"
        f"class OwnModulesDriver:\n    act = learn = greedy = {method}\n"
    )
    agent = load_plugin(texts / "driver.py")["own-modules-driver"]
    assert used(sys.modules[agent.__module__]) == {
        *("mine_other", "mine_package", "mine_package.values", "mine_package.constants", "mine_beside")
    }


def test_an_edited_text_is_read_again(texts: Path) -> None:
    module = importlib.import_module("mine_beside")
    assert "mine_unused" not in used(module)
    (texts / "mine_other.py").write_text("import mine_unused  # added now\n")
    assert "mine_unused" in used(module)

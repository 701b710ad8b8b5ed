"""What all tests share."""

import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from agents import QLearning, Sarsa, registry
from arena import Entrant, Evaluation, Tournament, Training

# Compiled kernels are kept apart from the user's, and from one run of the tests to the next.
KERNELS = Path(__file__).parent.parent / ".pytest_cache" / "kernels"
os.environ.setdefault("ARENA_CACHE_DIR", str(KERNELS))

NOT_FAST = {"timing", "system", "docs", "browser", "statistical", "exhaustive"}
"""The marks that say why a test is not among the fast ones; pyproject.toml explains them."""


def pytest_configure(config: pytest.Config) -> None:
    """Refuse ``-m`` with a mark that there is not, which would select all tests, or none."""
    marks = {re.split(r"[:(]", line)[0] for line in config.getini("markers")}
    unknown = {*re.findall(r"\w+", config.option.markexpr)} - marks - {"and", "or", "not"}
    if unknown:
        raise pytest.UsageError(f"-m: there is no mark {', '.join(sorted(unknown))}; see pytest --markers")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark as fast what has no reason not to be, and measure nothing beside another worker's tests."""
    for item in items:
        marks = {mark.name for mark in item.iter_markers()}
        if not marks & NOT_FAST:
            item.add_marker("fast")
        if "timing" in marks and "PYTEST_XDIST_WORKER" in os.environ:
            item.add_marker(pytest.mark.skip(reason="other tests beside it would be measured, too: -n 0"))


@pytest.fixture
def isolated_registry() -> Iterator[None]:
    """What the test registers, no other finds."""
    with registry.isolated():
        yield


@pytest.fixture
def small() -> Tournament:
    """Two entrants that are done in a moment, on either driver."""
    return Tournament(
        (Entrant("q", QLearning, bins=(5, 6)), Entrant("s", Sarsa, bins=(6, 5))),
        training=Training(episodes=6, max_steps=120),
        evaluation=Evaluation(episodes=5, max_steps=150),
        replicates=2,
        seed=7,
        name="small",
    )

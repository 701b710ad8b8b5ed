"""What scripts/clients wants to know of a run of one client's tests, as JSON."""

import json
import platform
import time
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

_BESIDE = ("pettingzoo", "gymnasium", "numpy")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--clients-report", type=Path, help="file to write")
    parser.addoption("--clients-package", help="whose version is told")


class Report:
    """Collects the results of the tests and writes them."""

    def __init__(self, path: Path, package: str) -> None:
        self.path, self.package = path, package
        self.tests: dict[str, dict[str, Any]] = {}
        self.began = time.perf_counter()

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        for item in items:
            function = getattr(item, "function")  # noqa: B009 (of functions only)
            mark = item.get_closest_marker("theirs")
            self.tests[_function(item.nodeid)] = {
                "what": " ".join(function.__doc__.split()),
                "line": function.__code__.co_firstlineno,
                "theirs": mark.args[0] if mark else "",
                "passed": True,
            }

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.tests[_function(report.nodeid)]["passed"] &= report.passed

    def pytest_sessionfinish(self) -> None:
        names = dict.fromkeys([self.package, *_BESIDE])
        told = {
            "date": datetime.now(UTC).date().isoformat(),
            "seconds": time.perf_counter() - self.began,
            "versions": {name: version(name) for name in names} | {"Python": platform.python_version()},
            "tests": list(self.tests.values()),
        }
        self.path.write_text(json.dumps(told, indent=1))


def _function(nodeid: str) -> str:
    """One row for all parameters of a test."""
    return nodeid.partition("[")[0]


def pytest_configure(config: pytest.Config) -> None:
    path = config.getoption("--clients-report")
    if path:
        config.pluginmanager.register(Report(path, config.getoption("--clients-package")))

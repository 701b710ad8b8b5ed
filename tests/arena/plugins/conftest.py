"""What the tests of plugins share."""

from pathlib import Path

import pytest
from plugin_files import write_files


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, isolated_registry: None) -> Path:
    """The current folder, with a plugin and a race in it. What a test registers, no other finds."""
    monkeypatch.chdir(tmp_path)
    write_files()
    return tmp_path

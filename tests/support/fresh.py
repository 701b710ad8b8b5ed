"""Processes that have imported nothing yet."""

import subprocess
import sys
from pathlib import Path

COMMAND = "import sys; from arena.cli import main; assert main(sys.argv[1:]) == 0"


def output_of(code: str, *arguments: str, cwd: Path | None = None) -> str:
    """What a process prints that runs ``code``, which must end well."""
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout


def modules_after(code: str, *arguments: str) -> set[str]:
    """The names of all modules that are imported when ``code`` has run."""
    return {*output_of(f"{code}; print('\\0', *sys.modules)", *arguments).partition("\0")[2].split()}


def modules_of_command(*arguments: str) -> set[str]:
    """Those that the command ``arena`` needs with these arguments."""
    return modules_after(COMMAND, *arguments)

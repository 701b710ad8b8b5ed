"""Arguments and options that several commands share."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

File = Annotated[Path, typer.Argument(help="Results file.", metavar="FILE")]
Confidence = Annotated[float, typer.Option(help="Of intervals and tests.", metavar="C")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
Plugins = Annotated[
    list[Path] | None,
    typer.Option("--plugin", help="A Python file with agents; may be given again.", metavar="FILE"),
]


class By(StrEnum):
    """Choices of ``--by``."""

    STEPS = "steps"
    ACCURACY = "accuracy"
    LENGTH = "length"
    REGRET = "regret"
    ITERATIONS = "iterations"


def load_plugins(paths: list[Path] | None) -> None:
    """Load each.

    Raises:
        PluginError: when one cannot be loaded.
    """
    from arena.plugins.loading import load_plugin

    for path in paths or ():
        load_plugin(path)

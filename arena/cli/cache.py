"""The command ``arena cache``."""

import json
from typing import Annotated

import typer

from arena.cli.console import answer
from arena.cli.options import AsJson


def cache(
    prune: Annotated[bool, typer.Option("--prune", help="Remove what has not been used for long.")] = False,
    days: Annotated[int, typer.Option(help="How long that is.", metavar="N", min=0)] = 30,
    as_json: AsJson = False,
) -> None:
    """Show the folder of compiled kernels, how many there are and their size; or clear it up."""
    from envs.compilation.kernel_folder import kept_kernels, kernel_folder

    folder = kernel_folder()
    kernels = {kernel: kernel.size() for kernel in kept_kernels(folder)}
    old = {kernel: size for kernel, size in kernels.items() if kernel.unused(days)}
    if prune:
        for kernel in old:
            kernel.remove()
            del kernels[kernel]
    word = "removed" if prune else "unused"
    counts = {"kernels": len(kernels), "bytes": sum(kernels.values())}
    old_counts = {word: len(old), f"{word}_bytes": sum(old.values())}
    if as_json:
        answer(json.dumps({"folder": str(folder), "days": days, **counts, **old_counts}))
        return
    answer(f"{folder}: {_words(*counts.values())}")
    rest = "removed, as" if prune else "of these"
    answer(f"{rest} not used for {days} days: {_words(*old_counts.values())}")


def _words(kernels: int, size: int) -> str:
    return f"{kernels} kernel{'s' * (kernels != 1)}, {size / 1e6:.1f} MB"


def add_commands(app: typer.Typer) -> None:
    """Make it a command of ``app``."""
    app.command()(cache)

"""The command ``arena``."""

from arena.cli.main import entry, main

__all__ = ["entry", "main"]

"""``python -m arena`` is the command ``arena``."""

from arena.cli.main import entry

entry()

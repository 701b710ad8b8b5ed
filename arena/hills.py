"""Hills by name, and from TOML files."""

import tomllib
from pathlib import Path
from typing import Any

from envs import Hill
from envs.checks import choice

HILLS = {"paper": Hill(), "constrained": Hill(dynamics="constrained")}
"""The paper's, Eq. (7), and the same with the full equation of motion (docs/physics.md)."""


def find_hill(name: str) -> Hill:
    """The hill that ``name`` means.

    Args:
        name: of one of ``HILLS``; or a TOML file, such as that of a tournament, whose table ``hill`` has
            arguments of ``Hill``.

    Raises:
        TypeError, ValueError: when there is none, or when it breaks a rule; the message names the file.
    """
    if name in HILLS:
        return HILLS[name]
    if not name.endswith(".toml"):
        raise ValueError(
            f"hill must be one of {', '.join(HILLS)}, or a file that ends in .toml, got {name!r}"
        )
    try:
        return _hill(tomllib.loads(Path(name).read_text(encoding="utf-8")))
    except FileNotFoundError:
        raise ValueError(f"there is no file {name}") from None
    except OSError as error:
        raise ValueError(f"{name}: {error.strerror or error}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{name} is not a TOML file: {error}") from error
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: {error}") from error


def _hill(content: dict[str, Any]) -> Hill:
    table = content.get("hill")
    if not isinstance(table, dict):
        raise TypeError(f"hill must be a table, got {table!r}")
    for key in table:
        choice("key of hill", key, Hill._fields)
    return Hill(**table)

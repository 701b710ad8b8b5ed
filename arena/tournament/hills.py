"""Hills by name, and from TOML files."""

from arena.tournament.configuration import build, read_toml
from arena.tournament.readings import READINGS
from envs import Hill
from envs.foundation.errors import InvalidValueError, naming

HILLS = {
    "paper": Hill(),
    "as-run": Hill()._replace(**READINGS["as-run"].hill),
    "constrained": Hill(dynamics="constrained"),
}
"""The paper's, Eq. (7); that of the reading ``as-run``; the full equation of motion (docs/physics.md)."""


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
        raise InvalidValueError(
            f"hill must be one of {', '.join(HILLS)}, or a file that ends in .toml, got {name!r}"
        )
    content = read_toml(name)
    with naming(name):
        hill: Hill = build("hill", Hill, content.get("hill"))
    return hill

"""Code of built-in agents that has been rewritten without changing a bit of what it learns.

A results file holds a digest of each agent's code. Runs of other code are not mixed with it; but the digests
of a row in ``data/equivalent_code.json`` are of versions of one agent that leave the same bits, which a file
of each release, kept with the tests and continued there, shows.
"""

import json
from functools import cache
from importlib import resources


def are_equivalent(agent: str, digest: str, other: str) -> bool:
    """Whether two versions of an agent's code leave the same bits.

    Args:
        agent: its name in files.
        digest: of one version of its code, see ``source_digests``.
        other: of another one.
    """
    return digest == other or {digest, other} <= equivalent_code().get(agent, frozenset())


@cache
def equivalent_code() -> dict[str, frozenset[str]]:
    """The digests of the versions of each built-in agent that leave the same bits as today's."""
    text = resources.files("arena.results").joinpath("data", "equivalent_code.json").read_text("utf-8")
    return {agent: frozenset(digests) for agent, digests in json.loads(text).items()}

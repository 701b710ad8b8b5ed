"""Warnings that are told once, whichever process of ours comes upon them, and however often."""

import logging

_log = logging.getLogger("arena")
_told: set[str] = set()
_held: list[str] | None = None  # in a worker, what its parent is to tell


def tell_once(sentence: str) -> None:
    """Log a warning, unless that has been done."""
    if sentence not in _told:
        _told.add(sentence)
        if _held is None:
            _log.warning(sentence)
        else:
            _held.append(sentence)


def hold_back() -> None:
    """From now on this process leaves it to its parent to tell."""
    global _held  # noqa: PLW0603 (a worker is a worker to its end)
    _held = _held or []


def held_back() -> list[str]:
    """What the parent is to tell, since the last call."""
    held = list(_held or ())
    if _held:
        _held.clear()
    return held

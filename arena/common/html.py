"""HTML of things in a notebook: tables, in which every text is escaped, and who shows what."""

from collections.abc import Iterable, Sequence
from functools import singledispatch
from html import escape
from importlib import import_module
from typing import Any

registrars: set[str] = set()
"""Names of the modules that register representations; they are imported when the first one is asked for."""


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table with a caption; ``heads`` are those of its columns."""
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    parts = f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return f"<table>{parts}</table>"


def represent(value: Any) -> str:
    """Return what a notebook shows of ``value``."""
    for module in registrars:
        import_module(module)
    return representation(value)


@singledispatch
def representation(value: Any) -> str:
    """The HTML of a value of any type, as long as no module has registered another for its type."""
    return f"<pre>{escape(repr(value))}</pre>"

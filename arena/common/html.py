"""HTML of things in a notebook: tables, in which every text is escaped, and who shows what."""

from collections.abc import Iterable, Sequence
from functools import singledispatch
from html import escape
from typing import Any


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table with a caption; ``heads`` are those of its columns."""
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    parts = f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return f"<table>{parts}</table>"


@singledispatch
def represent(value: Any) -> str:
    """What a notebook shows of ``value``; ``arena.report.notebook`` registers how."""
    return f"<pre>{escape(repr(value))}</pre>"

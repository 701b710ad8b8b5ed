"""Tables for terminals of any width."""

from copy import copy
from dataclasses import replace
from typing import Any

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Column, Table

_UNBOUNDED = 10_000


class FittedTable(Table):
    """A table that leaves out columns where not all fit, but cuts no value.

    Args:
        important: headers. The column of the first is always there, if need be beyond the terminal's edge;
            the others go last and in reverse, after those that are not named, from the right.
        look: arguments of ``Table``.
    """

    def __init__(self, *important: str, **look: Any) -> None:
        super().__init__(box=box.SIMPLE, **look)
        self._importance = {header: -place for place, header in enumerate(important)}

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render the columns that fit, for Rich."""
        shown = copy(self)
        while (needed := _needed(shown, console, options)) > options.max_width and len(shown.columns) > 1:
            least = min(reversed(shown.columns), key=self._importance_of)
            shown.columns = [column for column in shown.columns if column is not least]
        width = max(needed, options.max_width)
        return Table.__rich_console__(shown, console, options.update(width=width))

    def _importance_of(self, column: Column) -> int:
        return self._importance.get(str(column.header), -len(self.columns))


def _needed(table: Table, console: Console, options: ConsoleOptions) -> int:
    """The least width in which no value is cut."""
    narrow = copy(table)
    narrow.columns = [replace(column, width=_least(column)) for column in table.columns]
    wide = options.update(width=_UNBOUNDED)
    return Measurement(*Table.__rich_measure__(narrow, console, wide)).maximum


def _least(column: Column) -> int:
    """The width in which its values are whole; where it wraps, their words, unless it says how many."""
    texts = [str(cell) for cell in (column.header, *column.cells)]
    if not column.no_wrap:
        texts = [word for text in texts for word in text.split()]
    return column.min_width or max(map(cell_len, texts), default=1)

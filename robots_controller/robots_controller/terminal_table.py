"""TerminalTable: a table that fits into the width of its terminal, or into 80 columns of a pipe."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table

Kind = Literal['number', 'text', 'code', 'bar']
Columns = tuple[tuple[str, Kind], ...]
"""Name and kind of each."""
CODE_WIDTH: Final = 46
"""Characters of a line of a program, at most."""
SMALLEST_WIDTH: Final = 40


@dataclass(frozen=True)
class TerminalTable:
    """A table of texts.

    Where the columns do not fit side by side, those that are left over stand below, as a table of their own
    with the same first columns. Bars are left out there.

    Attributes:
        columns: Name and kind of each.
        rows: Its cells, with the markup of rich.
        keys: Number of first columns that say what a row is about.
    """

    columns: Sequence[tuple[str, Kind]]
    rows: Sequence[Sequence[str]] = field(repr=False)
    keys: int = 1

    def show(self, console: Console) -> None:
        """Print it."""
        for places in self._parts(console):
            console.print(self._table(places, console))

    def _parts(self, console: Console) -> list[list[int]]:
        """Numbers of the columns of each part."""
        options = console.options.update(width=10 * console.width)

        def width(content: Table | str) -> int:
            return Measurement.get(console, options, content).maximum

        # As wide as the whole table, and measured in a fraction of the time.
        widest = [[max(cells, key=width) for cells in zip(*self.rows, strict=True)]] if self.rows else []
        row = TerminalTable(self.columns, widest)
        keys = list(range(self.keys))
        parts = [keys]
        for place in range(self.keys, len(self.columns)):
            if width(row._table([*parts[-1], place], console)) <= max(console.width, SMALLEST_WIDTH):
                parts[-1] = [*parts[-1], place]
            elif self.columns[place][1] != 'bar':
                parts.append([*keys, place])
        return parts

    def _table(self, places: Sequence[int], console: Console) -> Table:
        table = Table(box=SIMPLE_HEAD, header_style='bold', pad_edge=False, collapse_padding=True)
        widest = max(console.width, SMALLEST_WIDTH) // 2
        for place in places:
            name, kind = self.columns[place]
            table.add_column(
                _halves(name),
                justify='right' if kind == 'number' else 'left',
                no_wrap=kind != 'text',
                max_width={'code': min(CODE_WIDTH, widest), 'text': widest}.get(kind),
                overflow='fold' if kind == 'text' else 'ellipsis',
            )
        for row in self.rows:
            table.add_row(*(row[place] for place in places))
        return table


def _halves(name: str) -> str:
    """A name on two lines, as even as words permit."""
    cuts = [place for place, letter in enumerate(name) if letter == ' ']
    if not cuts:
        return name
    cut = min(cuts, key=lambda place: abs(2 * place - len(name)))
    return f'{name[:cut]}\n{name[cut + 1 :]}'

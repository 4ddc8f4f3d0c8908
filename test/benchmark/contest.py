"""Solvers that take turns on the same problems, and the table of what came out."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from rich.console import Console
from rich.table import Table


@dataclass
class Contest:
    """Times per problem (us) of solvers that take turns, so that a busy machine hits all of them.

    Attributes:
        calls: Each solves all problems.
        clock: The processor's time for this process by default: other work on the machine does not count in.
    """

    calls: dict[str, Callable[[], object]]
    clock: Callable[[], float] = time.process_time
    times: dict[str, list[float]] = field(default_factory=dict)
    results: dict[str, object] = field(default_factory=dict)

    def run(self, repetitions: int, count: int) -> None:
        """Each call works on `count` problems."""
        for name, call in self.calls.items():
            self.results[name] = call()  # warm
        for _ in range(repetitions):
            for name, call in self.calls.items():
                start = self.clock()
                call()
                self.times.setdefault(name, []).append(1e6 * (self.clock() - start) / count)

    def median(self, name: str) -> float:
        return float(np.median(self.times[name]))


@dataclass(frozen=True)
class Row:
    """One line of the table: times in us per problem, `ours` and the peer's.

    Attributes:
        what: The block or call.
        robot: Its name.
        ours: us.
        peer: Name of the peer; empty where there is none.
        theirs: us.
        target: Largest ratio that we want.
        quality: What the solutions are worth, or more figures.
    """

    what: str
    robot: str
    ours: float
    peer: str = ''
    theirs: float = np.nan
    target: float = np.nan
    quality: str = ''

    @property
    def cells(self) -> tuple[str, ...]:
        ratio = self.ours / self.theirs
        return (
            self.what,
            f'`{self.robot}`',
            _time(self.ours),
            f'{_time(self.theirs)} ({self.peer})' if self.peer else '',
            f'{ratio:.2f}' if self.peer else '',
            '' if np.isnan(self.target) else f'{self.target:g}',
            self.quality,
        )

    @property
    def missed(self) -> bool:
        return self.ours > self.target * self.theirs


HEADINGS = ('what', 'robot', 'ours', 'peer', 'ratio', 'at most', 'solutions')


def show(rows: list[Row], title: str, *, markdown: bool) -> None:
    """Print the table, as Markdown for the documentation or for the terminal."""
    if markdown:
        print(f'{title}:\n')
        for cells in (HEADINGS, ('---',) * len(HEADINGS), *(row.cells for row in rows)):
            print(f'| {" | ".join(cells)} |')
        return
    table = Table(title=title)
    for heading in HEADINGS:
        table.add_column(heading)
    for row in rows:
        table.add_row(*row.cells, style='red' if row.missed else None)
    Console(width=170).print(table)


def _time(value: float) -> str:
    return f'{1e-6 * value:.2f} s' if value > 1e5 else f'{value:.1f} µs'

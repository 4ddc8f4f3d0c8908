"""What these commands print: tables for terminal and documentation, and the machine they ran on."""

import datetime as dt
import os
import platform
from pathlib import Path

from rich.console import Console

from robots_controller.report.tables import ReportTable


def show(table: ReportTable, *, markdown: bool = False) -> None:
    """Print a table, for a terminal or as Markdown."""
    print(f'\n{table.title}\n', flush=True)
    if markdown:
        print(as_markdown(table), flush=True)
    else:
        table.show(Console(width=170))


def as_markdown(table: ReportTable) -> str:
    """A table as documentation has it."""
    rules = ['---:' if kind == 'number' else '---' for _, kind in table.columns]
    rows = [[name for name, _ in table.columns], rules, *(row.cells for row in table.rows)]
    return '\n'.join(
        f'| {" | ".join(cell.replace("|", chr(92) + "|") for cell in cells)} |' for cells in rows
    )


def machine() -> str:
    """The machine, how busy it is, and the day."""
    cores = len(os.sched_getaffinity(0))
    today = f'{dt.datetime.now(tz=dt.UTC):%-d %B %Y}'
    return (
        f'{today}; {cores} cores of {_processor()}, load {os.getloadavg()[0]:.1f}, '
        f'Linux {platform.release()}, Python {platform.python_version()}'
    )


def _processor() -> str:
    for line in Path('/proc/cpuinfo').read_text().splitlines():
        if line.startswith('model name'):
            return line.partition(':')[2].strip()
    return platform.machine()

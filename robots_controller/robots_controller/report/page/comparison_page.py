"""Two runs side by side: one HTML file, and a table for the terminal."""

from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape

from robots_controller.report.comparison import RunComparison
from robots_controller.report.line_times import ACTIVITIES
from robots_controller.report.page.page import figure, page_table, page_text
from robots_controller.report.page.page_data import PageArrays
from robots_controller.report.page.page_panels import io_panels, lines_panel, spans_panel, speed_panel
from robots_controller.report.page.page_world import world
from robots_controller.report.run_report import RunReport
from robots_controller.report.tables import change_table, largest_table, trend

NAMES = ('A', 'B')


def comparison_page(comparison: RunComparison) -> str:
    """The HTML text of a comparison: the first run is A, the second B."""
    arrays = PageArrays()
    runs = list(zip(NAMES, (comparison.before, comparison.after), strict=True))
    data = {
        'title': f'{comparison.after.title}: {comparison.describe()}',
        'subtitle': '; '.join(f'{name}: {report.run.source}' for name, report in runs),
        'problems': [f'{name}: {text}' for name, report in runs for text in report.problems],
        'figures': _figures(comparison),
        'duration': max(report.run.duration for _, report in runs),
        'lines': page_table(change_table(comparison)),
        'motions': page_table(largest_table(comparison)),
        'panels': [
            spans_panel(runs),
            speed_panel(runs, arrays),
            *_joint_panels(runs, arrays),
            *io_panels(runs, arrays),
        ],
        'world': world((comparison.before, comparison.after), arrays),
    }
    return page_text(data, arrays)


def show_comparison(comparison: RunComparison, console: Console) -> None:
    """Print what changed, line by line."""
    for name, report in zip(NAMES, (comparison.before, comparison.after), strict=True):
        console.print(
            f'[bold]{name}[/]  {escape(report.title)}, {report.run.duration:.2f} s  '
            f'{escape(report.run.source)}',
            highlight=False,
        )
    change_table(comparison).show(console)
    console.print(f'[bold]B is {comparison.describe()}[/]', highlight=False)


def _figures(comparison: RunComparison) -> list[dict[str, str]]:
    before, after = comparison.before, comparison.after

    def pair(label: str, one: float, other: float, unit: str) -> dict[str, str]:
        difference = other - one
        part = f' ({100.0 * difference / one:+.1f} %)' if one else ''
        note = f'A {one:.2f} {unit}, {difference:+.2f}{part}'
        return figure(label, f'{other:.2f} {unit}', note, trend(difference))

    found = [pair('cycle time B', before.run.duration, after.run.duration, 's')]
    found += [pair(name, before.times[one], after.times[one], 's') for one, name in ACTIVITIES.items()]
    first, second = (float(report.energy.sum()) / 1e3 for report in (before, after))
    return [*found, pair('energy', first, second, 'kJ')]


def _joint_panels(runs: list[tuple[str, RunReport]], arrays: PageArrays) -> list[dict[str, Any]]:
    """Speeds and torques: the axis that is closest to its limit, of each run."""
    panels = []
    for title, quantity in (('Highest joint speed', 'velocity'), ('Highest torque', 'torque')):
        uses = [(r, (name,), 100.0 * r.signals.use[quantity].max(axis=1)) for name, r in runs]
        panels.append(lines_panel(title, '% of limit', uses, arrays, marks=[100.0]))
    powers = [(r, (name,), np.maximum(r.signals.power, 0.0).sum(axis=1) / 1e3) for name, r in runs]
    return [*panels, lines_panel('Mechanical power taken up', 'kW', powers, arrays)]

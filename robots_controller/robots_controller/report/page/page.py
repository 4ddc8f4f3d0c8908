"""report_page: a run as one HTML file that needs nothing else, and no network."""

import json
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, Final

from robots_controller.report.line_times import ACTIVITIES
from robots_controller.report.motion_columns import PAGE
from robots_controller.report.page.page_data import PageArrays
from robots_controller.report.page.page_panels import run_panels
from robots_controller.report.page.page_world import world
from robots_controller.report.run_report import RunReport
from robots_controller.report.run_signals import LIMITS
from robots_controller.report.tables import ReportTable, line_table, motion_table
from robots_core.errors import UnreadableFileError

SHORTEST: Final = 1e-9  # s; a program that fails at once has no duration to divide by
SCRIPTS: Final = ('data.js', 'timeline.js', 'panels.js', 'view3d.js', 'main.js')


def report_page(report: RunReport) -> str:
    """The HTML text of a report."""
    arrays = PageArrays()
    run = report.run
    data = {
        'title': report.title,
        'subtitle': f'{run.source}, program {run.program_state.lower()}',
        'problems': list(report.problems),
        'figures': _figures(report),
        'duration': run.duration,
        'lines': page_table(line_table(report)),
        'motions': page_table(motion_table(report, PAGE)),
        'panels': run_panels(report, arrays),
        'world': world((report,), arrays),
    }
    return page_text(data, arrays)


def page_text(data: dict[str, Any], arrays: PageArrays) -> str:
    """The HTML text of a page's data."""
    folder = files(__package__)
    script = '\n'.join((folder / name).read_text(encoding='utf-8') for name in SCRIPTS)
    text = json.dumps({**data, 'arrays': arrays.items}, allow_nan=False, separators=(',', ':'))
    return Template((folder / 'page.html').read_text(encoding='utf-8')).substitute(
        title=escape(str(data['title'])),
        style=(folder / 'style.css').read_text(encoding='utf-8'),
        # Nothing in the data can end the element that holds it.
        data=text.replace('<', '\\u003c'),
        script=script,
    )


def page_table(table: ReportTable) -> dict[str, Any]:
    """A table for the page."""
    columns = [{'name': name, 'kind': kind} for name, kind in table.columns]
    return {'title': table.title, 'columns': columns, 'rows': [vars(row) for row in table.rows]}


def write_page(path: Path | str, text: str) -> None:
    """Write a page; its folder is made.

    Raises:
        RobotsError: the file cannot be written.
    """
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Path(path).write_text(text, encoding='utf-8')
    except OSError as error:
        raise UnreadableFileError(
            f'the report cannot be written to {path}: {error.strerror or error}'
        ) from error


def figure(label: str, value: str, note: str = '', trend: str = '') -> dict[str, str]:
    """One of the large numbers at the top."""
    return {'label': label, 'value': value, 'note': note, 'trend': trend}


def _figures(report: RunReport) -> list[dict[str, str]]:
    times, run = report.times, report.run
    shares = (
        f'{name} {100.0 * times[activity] / max(run.duration, SHORTEST):.0f} %'
        for activity, name in ACTIVITIES.items()
    )
    found = [
        figure('cycle time', f'{run.duration:.2f} s', ', '.join(shares)),
        figure(
            'energy',
            f'{report.energy.sum() / 1e3:.2f} kJ',
            f'mechanical, {"of the drives" if report.signals.measured else "by inverse dynamics"}',
        ),
        figure('fastest', f'{report.signals.tool_speed.max():.2f} m/s', 'of the tool'),
    ]
    if report.farthest is not None:
        worst = report.farthest
        found.append(
            figure(
                'measured off path',
                f'{1e3 * worst.path_deviation:.3f} mm',
                f'at most, in line {report.place(worst.motion)}',
            )
        )
        quantity = max(LIMITS, key=lambda name: report.uses[name].ratio)
        use = report.uses[quantity]
        found.append(figure('highest use', f'{100.0 * use.ratio:.0f} %', f'{quantity} of {use.joint}'))
    if report.clearance is not None:
        near = report.clearance
        found.append(
            figure(
                'smallest distance',
                f'{1e3 * near.smallest:.1f} mm',
                f'{near.first} to {near.second}, {near.time:.2f} s',
                'worse' if near.smallest <= 0.0 else '',
            )
        )
    return found

"""write_report: a run as one HTML file that needs nothing else, and no network."""

from __future__ import annotations

import json
import math
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, Final

from robots_controller.report.line_times import time_spans
from robots_controller.report.motion_figures import MotionFigures
from robots_controller.report.page.page_data import PageArrays
from robots_controller.report.page.page_panels import run_panels
from robots_controller.report.page.page_world import world
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.report.terminal import number, place
from robots_core.errors import RobotsError

SHORTEST: Final = 1e-9  # s; a program that fails at once has no duration to divide by
SCRIPTS: Final = ('data.js', 'timeline.js', 'panels.js', 'view3d.js', 'main.js')


def write_report(
    bag: Path | str,
    path: Path | str,
    *,
    robot: str = '',
    scene: Path | str | None = None,
    namespace: str = '/',
    source: str = '',
) -> RunReport:
    """Write the report on a recorded run, live or simulated.

    Args:
        bag: The recorded bag.
        path: The HTML file to write; its folder is made.
        robot: The robot's name; by default the one that the bag names.
        scene: YAML file of what stands around the robot; distances are told with it.
        namespace: Namespace of the recorded cell.
        source: Where the run comes from, for a person; the bag's path by default.

    Returns:
        What was written.

    Raises:
        RobotsError: not a readable bag, an unknown robot, a scene that is not valid, or a file that cannot
            be written.
    """
    report = run_report(bag, robot=robot, scene=scene, namespace=namespace, source=source)
    write_page(path, report_page(report))
    return report


def report_page(report: RunReport) -> str:
    """The HTML text of a report."""
    arrays = PageArrays()
    run = report.run
    problems = [text for text in (run.problem, run.program_error) if text]
    problems += [f'line {m.line}: {m.message}' for m in run.motions if not m.ok]
    data = {
        'title': report.title,
        'subtitle': f'{run.source}, program {run.program_state.lower()}',
        'problems': list(dict.fromkeys(problems)),
        'figures': _figures(report),
        'duration': run.duration,
        'lines': _lines(report),
        'motions': _motions(report),
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
        title=_escaped(str(data['title'])),
        style=(folder / 'style.css').read_text(encoding='utf-8'),
        # Nothing in the data can end the element that holds it.
        data=text.replace('<', '\\u003c'),
        script=script,
    )


def write_page(path: Path | str, text: str) -> None:
    """Write a page; its folder is made.

    Raises:
        RobotsError: the file cannot be written.
    """
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Path(path).write_text(text, encoding='utf-8')
    except OSError as error:
        raise RobotsError(f'the report cannot be written to {path}: {error.strerror or error}') from error


def _escaped(text: str) -> str:
    return text.replace('&', '&amp;').replace('<', '&lt;')


def figure(label: str, value: str, note: str = '', trend: str = '') -> dict[str, str]:
    """One of the large numbers at the top."""
    return {'label': label, 'value': value, 'note': note, 'trend': trend}


def _figures(report: RunReport) -> list[dict[str, str]]:
    times, run = report.times, report.run
    shares = (
        f'{name} {100.0 * times[key] / max(run.duration, SHORTEST):.0f} %'
        for key, name in (('moving', 'moving'), ('waiting', 'waiting'), ('io', 'I/O'))
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
    if report.motions:
        worst = max(report.motions, key=lambda item: item.path_deviation)
        found.append(
            figure(
                'path accuracy',
                f'{1e3 * worst.path_deviation:.3f} mm',
                f'worst, in line {place(worst.motion, {line.file for line in report.lines})}',
            )
        )
        highest = max(
            (
                (use, f'{quantity} of {joint}')
                for m in report.motions
                for quantity, (joint, use) in m.uses.items()
            ),
        )
        found.append(figure('highest use', f'{100.0 * highest[0]:.0f} %', highest[1]))
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


def columns(*named: tuple[str, str]) -> list[dict[str, str]]:
    """Columns of a table: name and kind."""
    return [{'name': name, 'kind': kind} for name, kind in named]


def _lines(report: RunReport) -> dict[str, Any]:
    rows = []
    spans = time_spans(report.run)
    files_ = {line.file for line in report.lines}
    for line in report.lines:
        here = [[s.start, s.end] for s in spans if (s.file, s.line) == (line.file, line.line)]
        rows.append(
            {
                'cells': [
                    place(line, files_),
                    line.source,
                    str(line.visits),
                    *(f'{t:.2f}' if t >= 5e-3 else '' for t in (line.moving, line.waiting, line.io)),
                    f'{line.total:.2f}',
                    '',
                ],
                'bar': [line.moving, line.waiting, line.io],
                'spans': here,
            }
        )
    names = (('line', 'number'), ('', 'code'), ('visits', 'number'), ('moving', 'number'))
    more = (('waiting', 'number'), ('I/O', 'number'), ('total s', 'number'), ('', 'bar'))
    return {'title': 'Cycle time by line', 'columns': columns(*names, *more), 'rows': rows}


def _motions(report: RunReport) -> dict[str, Any]:
    names = [('line', 'number'), ('motion', 'text'), ('planned s', 'number'), ('real s', 'number')]
    names += [('way m', 'number'), ('top m/s', 'number'), ('decided by', 'text'), ('of its time', 'number')]
    names += [(quantity, 'text') for quantity in ('velocity', 'acceleration', 'torque')]
    names += [
        ('off path mm', 'number'),
        ('lag mm', 'number'),
        ('missed mm', 'number'),
        ('energy kJ', 'number'),
    ]
    files_ = {line.file for line in report.lines}
    rows = [
        {
            'cells': _motion_cells(item, files_),
            'spans': [[item.motion.start, item.motion.end]],
            'bad': not item.motion.ok,
        }
        for item in report.motions
    ]
    return {'title': 'Motions', 'columns': columns(*names), 'rows': rows}


def _motion_cells(item: MotionFigures, files_: set[str]) -> list[str]:
    uses = [f'{joint} {100.0 * use:.0f} %' for joint, use in item.uses.values()]
    return [
        place(item.motion, files_),
        item.motion.kind,
        number(item.planned, 2),
        number(item.duration, 2),
        number(item.length, 3),
        number(item.fastest, 2),
        item.deciding.describe(),
        '' if math.isnan(item.deciding.share) else f'{100.0 * item.deciding.share:.0f} %',
        *uses,
        number(1e3 * item.path_deviation, 3),
        number(1e3 * item.lag, 2),
        number(1e3 * item.missed, 3),
        number(item.energy / 1e3, 2),
    ]

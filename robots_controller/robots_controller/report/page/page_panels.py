"""The plots of the page: joints against their limits, tool, torques, distances, inputs and outputs."""

from collections.abc import Sequence
from math import ceil
from typing import Any, Final

import numpy as np

from robots_controller.report.page.page_data import PageArrays, series
from robots_controller.report.run_report import RunReport
from robots_core.validation import Array

COLOURS: Final = ('#0b7285', '#e8590c', '#6741d9', '#2b8a3e', '#c2255c', '#1c7ed6', '#b08900', '#495057')
FORCES: Final = {False: 'N m', True: 'N'}
NEAR_LIMIT: Final = 0.5
MOST_SAMPLES: Final = 20_000  # of a curve: 80 s at 250 Hz; longer runs are thinned out


def run_panels(report: RunReport, arrays: PageArrays) -> list[dict[str, Any]]:
    """All panels of a run."""
    signals, run = report.signals, report.run
    panels = [
        spans_panel([('program', report)]),
        *_joint_panels(report, arrays),
        speed_panel([('tool', report)], arrays),
        lines_panel('Tool position', 'm', [(report, 'xyz', signals.tool)], arrays),
        lines_panel('Tool behind its reference', 'mm', [(report, ('distance',), 1e3 * signals.lag)], arrays),
        lines_panel(
            'Mechanical power', 'kW', [(report, run.robot.axes_data.names, signals.power / 1e3)], arrays
        ),
    ]
    curve = run.distance if report.clearance is None else report.clearance.curve
    if curve.size:
        drawn = series(arrays, 'smallest', curve[:, 0], 1e3 * curve[:, 1], COLOURS[0], show=(1.0, 0.0, 'mm'))
        panels.append(_panel('Distance to the next thing', 'mm', 'lines', [drawn]))
    return [*panels, *io_panels([('', report)], arrays)]


def lines_panel(
    title: str,
    unit: str,
    curves: Sequence[tuple[RunReport, Sequence[str], Array]],
    arrays: PageArrays,
    *,
    show: Sequence[tuple[float, float, str]] = (),
    **more: Any,
) -> dict[str, Any]:
    """A plot of curves over a run's time, or over the times of several.

    Args:
        title: What it shows.
        unit: Of its scale.
        curves: Run, names of curves, and their values, (m,) or (m, names).
        arrays: Where the numbers go.
        show: Scale, offset and unit of the number in the legend, by curve; those of the scale by default.
        more: Further properties of the panel.
    """
    drawn: list[dict[str, Any]] = []
    for report, names, values in curves:
        step = max(1, ceil(report.run.time.size / MOST_SAMPLES))
        for name, column in zip(names, values[::step].reshape(-1, len(names)).T, strict=True):
            number = len(drawn)
            shown = show[number] if show else (1.0, 0.0, unit.partition(' ')[0])
            time, colour = report.run.time[::step], COLOURS[number % len(COLOURS)]
            drawn.append(series(arrays, name, time, column, colour, show=shown))
    return _panel(title, unit, 'lines', drawn, **more)


def spans_panel(reports: list[tuple[str, RunReport]]) -> dict[str, Any]:
    """What the program did, a lane for each run, with the line's numbers."""
    lanes = [
        {
            'name': name,
            'spans': [
                [round(span.start, 4), round(span.end, 4), span.line, span.activity] for span in report.spans
            ],
        }
        for name, report in reports
    ]
    return _panel('Program: line by line', '', 'spans', [], lanes=lanes, rows=len(lanes))


def speed_panel(reports: list[tuple[str, RunReport]], arrays: PageArrays) -> dict[str, Any]:
    """Speed of the tool; of one run also what the references ask for."""
    curves = [(report, (name,), report.signals.tool_speed) for name, report in reports]
    panel = lines_panel('Tool speed', 'm/s', curves, arrays)
    if len(reports) == 1:
        report = reports[0][1]
        asked = lines_panel('', 'm/s', [(report, ('reference',), report.signals.reference_speed)], arrays)
        panel['series'].insert(0, asked['series'][0] | {'colour': '#868e96', 'dashed': True})
    return panel


def io_panels(reports: list[tuple[str, RunReport]], arrays: PageArrays) -> list[dict[str, Any]]:
    """Digital channels as a logic analyser shows them, then analog ones."""
    panels = []
    for sort, kind in (('digital', 'logic'), ('analog', 'steps')):
        rows = []
        for prefix, report in reports:
            for channel in report.run.io:
                if channel.name.startswith(sort):
                    name = f'{prefix} {channel.label or channel.name.removeprefix(f"{sort}_")}'.strip()
                    colour = COLOURS[0] if 'input' in channel.name else COLOURS[1]
                    rows.append(series(arrays, name, channel.time, channel.value, colour))
        if rows:
            panels.append(_panel(f'{sort.capitalize()} inputs and outputs', '', kind, rows))
    return panels


def _joint_panels(report: RunReport, arrays: PageArrays) -> list[dict[str, Any]]:
    run, signals, axes = report.run, report.signals, report.run.robot.axes_data
    q, q_dot = run.feedback
    middle, half = axes.middle_and_half
    half = np.where(np.isfinite(half), half, 2.0 * np.pi)  # of an endless axis a turn is 100 %
    angle = np.where(np.array(axes.prismatic), 1e3, 180.0 / np.pi)
    units = ['mm' if prismatic else '°' for prismatic in axes.prismatic]
    rates, accelerations = ([f'{unit}{per}' for unit in units] for per in ('/s', '/s²'))
    forces = [FORCES[prismatic] for prismatic in axes.prismatic]
    none = np.zeros(axes.num_axes)
    torques = f'Torques {"of the drives" if signals.measured else "by inverse dynamics"}'
    # Title, shares of the limit, what the legend shows at the limit and at 0, and its units.
    plots = (
        ('Joint positions in their range', (q - middle) / half, half * angle, middle * angle, units),
        ('Joint speeds', q_dot / axes.velocity, axes.velocity * angle, none, rates),
        (
            'Joint accelerations of the reference',
            run.reference[2] / axes.acceleration,
            axes.acceleration * angle,
            none,
            accelerations,
        ),
        (torques, signals.torque / axes.effort, axes.effort, none, forces),
    )
    return [
        lines_panel(
            title,
            '% of limit' if number else '% of range',
            [(report, axes.names, 100.0 * shares)],
            arrays,
            show=list(zip((0.01 * full).tolist(), offset.tolist(), names, strict=True)),
            marks=[-100.0, 100.0],
            # Limits that are far away would press the curves flat.
            range=[-100.0, 100.0] if np.abs(shares).max() > NEAR_LIMIT else None,
        )
        for number, (title, shares, full, offset, names) in enumerate(plots)
    ]


def _panel(title: str, unit: str, kind: str, drawn: list[dict[str, Any]], **more: Any) -> dict[str, Any]:
    return {'title': title, 'unit': unit, 'kind': kind, 'series': drawn, **more}

"""The plots of the page: joints against their limits, tool, torques, distances, inputs and outputs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from robots_controller.report.line_times import time_spans
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
    axes = run.robot.axes_data
    panels = [spans_panel([('program', report)]), *_joint_panels(report, arrays)]
    step = _step(report)
    time = run.time[::step]
    metres = (1.0, 0.0, 'm')
    panels += [
        speed_panel([('tool', report)], arrays),
        {
            'title': 'Tool position',
            'unit': 'm',
            'kind': 'lines',
            'series': [
                series(arrays, name, time, signals.tool[::step, index], COLOURS[index], show=metres)
                for index, name in enumerate('xyz')
            ],
        },
        {
            'title': 'Tool behind its reference',
            'unit': 'mm',
            'kind': 'lines',
            'series': [_lag(report, arrays, step)],
        },
        {
            'title': 'Mechanical power',
            'unit': 'kW',
            'kind': 'lines',
            'series': [
                series(
                    arrays,
                    name,
                    time,
                    signals.power[::step, axis] / 1e3,
                    COLOURS[axis % len(COLOURS)],
                    show=(1.0, 0.0, 'kW'),
                )
                for axis, name in enumerate(axes.names)
            ],
        },
    ]
    curve = run.distance if report.clearance is None else report.clearance.curve
    if curve.size:
        drawn = series(arrays, 'smallest', curve[:, 0], 1e3 * curve[:, 1], COLOURS[0], show=(1.0, 0.0, 'mm'))
        panels.append(
            {'title': 'Distance to the next thing', 'unit': 'mm', 'kind': 'lines', 'series': [drawn]}
        )
    return [*panels, *io_panels([('', report)], arrays)]


def spans_panel(reports: list[tuple[str, RunReport]]) -> dict[str, Any]:
    """What the program did, a lane for each run, with the line's numbers."""
    lanes = [
        {
            'name': name,
            'spans': [
                [round(span.start, 4), round(span.end, 4), span.line, span.activity]
                for span in time_spans(report.run)
            ],
        }
        for name, report in reports
    ]
    return {
        'title': 'Program: line by line',
        'unit': '',
        'kind': 'spans',
        'series': [],
        'lanes': lanes,
        'rows': len(lanes),
    }


def speed_panel(reports: list[tuple[str, RunReport]], arrays: PageArrays) -> dict[str, Any]:
    """Speed of the tool; of one run also what the references ask for."""
    curves = []
    for number, (name, report) in enumerate(reports):
        step, unit = _step(report), (1.0, 0.0, 'm/s')
        time, signals = report.run.time[::step], report.signals
        if len(reports) == 1:
            speed = signals.reference_speed[::step]
            curves.append(series(arrays, 'reference', time, speed, '#868e96', show=unit, dashed=True))
        curves.append(series(arrays, name, time, signals.tool_speed[::step], COLOURS[number], show=unit))
    return {'title': 'Tool speed', 'unit': 'm/s', 'kind': 'lines', 'series': curves}


def io_panels(reports: list[tuple[str, RunReport]], arrays: PageArrays) -> list[dict[str, Any]]:
    """Digital channels as a logic analyser shows them, then analog ones."""
    panels = []
    for digital, title in ((True, 'Digital inputs and outputs'), (False, 'Analog inputs and outputs')):
        rows = []
        for prefix, report in reports:
            for channel in report.run.io:
                if channel.digital is digital:
                    short = channel.name.replace('digital_', '').replace('analog_', '')
                    name = f'{prefix} {channel.label or short}'.strip()
                    colour = COLOURS[0] if 'input' in channel.name else COLOURS[1]
                    rows.append(
                        series(arrays, name, channel.time, channel.value, colour, digital=channel.digital)
                    )
        if rows:
            kind = 'logic' if digital else 'steps'
            panels.append({'title': title, 'unit': '', 'kind': kind, 'series': rows})
    return panels


def _joint_panels(report: RunReport, arrays: PageArrays) -> list[dict[str, Any]]:
    run, signals = report.run, report.signals
    axes = run.robot.axes_data
    q, q_dot = run.feedback
    bounded = ~axes.continuous
    middle = np.where(bounded, 0.5 * (np.where(bounded, axes.lower, 0.0) + axes.upper), 0.0)
    half = np.where(bounded, axes.upper - middle, 2.0 * np.pi)  # of an endless axis a turn is 100 %
    middle = np.where(bounded, middle, 0.0)
    angle = np.where(np.array(axes.prismatic), 1e3, 180.0 / np.pi)
    units = ['mm' if prismatic else '°' for prismatic in axes.prismatic]
    source = 'of the drives' if signals.measured else 'by inverse dynamics'
    forces = [FORCES[prismatic] for prismatic in axes.prismatic]

    def panel(title: str, values: Array, show: Callable[[int], tuple[float, float, str]]) -> dict[str, Any]:
        step = _step(report)
        return {
            'title': title,
            'unit': '% of limit',
            'kind': 'lines',
            'marks': [-100.0, 100.0],
            # Limits that are far away would press the curves flat.
            'range': [-100.0, 100.0] if np.abs(values).max() > NEAR_LIMIT else None,
            'series': [
                series(
                    arrays,
                    name,
                    run.time[::step],
                    100.0 * values[::step, axis],
                    COLOURS[axis % len(COLOURS)],
                    show=show(axis),
                )
                for axis, name in enumerate(axes.names)
            ],
        }

    def of(limit: Array, unit: list[str], factor: Array) -> Callable[[int], tuple[float, float, str]]:
        return lambda axis: (0.01 * float(limit[axis] * factor[axis]), 0.0, unit[axis])

    position = panel(
        'Joint positions in their range',
        (q - middle) / half,
        lambda axis: (
            0.01 * float(half[axis] * angle[axis]),
            float(middle[axis] * angle[axis]),
            units[axis],
        ),
    )
    rates = [f'{unit}/s' for unit in units]
    accelerations = [f'{unit}/s²' for unit in units]
    return [
        {**position, 'unit': '% of range'},
        panel('Joint speeds', q_dot / axes.velocity, of(axes.velocity, rates, angle)),
        panel(
            'Joint accelerations of the reference',
            run.reference[2] / axes.acceleration,
            of(axes.acceleration, accelerations, angle),
        ),
        panel(
            f'Torques {source}', signals.torque / axes.effort, of(axes.effort, forces, np.ones(axes.num_axes))
        ),
    ]


def _lag(report: RunReport, arrays: PageArrays, step: int) -> dict[str, Any]:
    away = 1e3 * np.linalg.norm(report.signals.tool - report.signals.tool_reference, axis=1)
    return series(
        arrays, 'distance', report.run.time[::step], away[::step], COLOURS[0], show=(1.0, 0.0, 'mm')
    )


def _step(report: RunReport) -> int:
    return max(1, -(-report.run.time.size // MOST_SAMPLES))

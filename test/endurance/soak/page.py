"""The figures of a long run as one HTML page, in the style of reports."""

import html
from collections.abc import Callable, Iterable, Sequence
from importlib.resources import files
from typing import Final

import numpy as np

from robots_controller.report.tables import ReportTable
from robots_core.validation import Array

from .figures import LATE, LoopFigures, SoakFigures
from .summary import closing_line, loop_table, memory_table

WIDTH, HEIGHT, LEFT, BOTTOM, TOP = 1000, 240, 62, 30, 8
COLOURS: Final = (
    '#0b8a83',
    '#e8890c',
    '#4263eb',
    '#c2255c',
    '#5f3dc4',
    '#2b8a3e',
    '#868e96',
    '#d9480f',
    '#1098ad',
)
BINS: Final = 60
MARKS: Final = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0)  # ms
MOST_POINTS: Final = 600
STYLE: Final = """
svg { display: block; width: 100%; height: auto; }
svg text { font: 11px system-ui, "Segoe UI", sans-serif; fill: var(--soft); }
svg .grid { stroke: var(--line); } svg .goal { stroke: var(--bad); stroke-dasharray: 5 4; }
svg .goal-text { fill: var(--bad); }
.legends { display: flex; flex-wrap: wrap; gap: 4px 16px; margin: 2px 0 6px 62px; }
.legends { font-size: 12px; color: var(--soft); }
.legends i { display: inline-block; width: 13px; height: 3px; border-radius: 2px; margin-right: 6px; }
.legends i { vertical-align: middle; }
td:first-child, th:first-child { text-align: left; }
td:first-child { font-family: var(--mono); font-size: 12px; }
.wide { display: grid; grid-template-columns: 5fr 3fr; gap: 14px; }
@media (max-width: 900px) { .wide { grid-template-columns: 1fr; } }
"""


def soak_page(figures: SoakFigures) -> str:
    """The HTML text."""
    style = (files('robots_controller.report.page') / 'style.css').read_text(encoding='utf-8')
    title = f'A cell for {figures.duration / 60.0:.0f} minutes'
    problems = ''.join(f'<div>{html.escape(line)}</div>' for line in figures.missed_goals)
    body = [
        f'<header><h1>{title}</h1><p>{html.escape(figures.machine)}</p></header>',
        f'<div class="problems">{problems}</div>' if problems else '',
        f'<div class="figures">{"".join(_figures(figures))}</div>',
        _card(
            'Lateness',
            'from when a message was due until it was sent; number of messages',
            _histogram(figures),
        ),
        _card('Latest message', 'of each part of the run, ms', _lateness(figures)),
        _card('Memory', 'that a process shares with no file, MB more than at the start', _memory(figures)),
        '<div class="wide">',
        _table(loop_table(figures)),
        _table(memory_table(figures)),
        '</div>',
        f'<p class="hint">{html.escape(closing_line(figures))}</p>',
    ]
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{title}</title><style>{style}{STYLE}</style></head>\n<body><main>{"".join(body)}</main></body></html>\n'
    )


def _figures(figures: SoakFigures) -> Iterable[str]:
    yield _figure(
        'program', f'{figures.runs} runs', f'jogged {figures.jogs} times, {figures.inputs} changes of inputs'
    )
    for loop in figures.loops:
        _, _, often, rarely = loop.percentiles
        yield _figure(f'{loop.name}, p99.9', f'{1e3 * often:.2f} ms', f'p99.99 {1e3 * rarely:.2f} ms')
        yield _figure(
            f'{loop.name}, more than {1e3 * LATE:g} ms late',
            str(loop.missed),
            f'of {loop.late.size}, worst {1e3 * loop.worst:.1f} ms',
        )
    if figures.memory:
        worst = max(figures.memory, key=lambda one: one.slope)
        yield _figure('fastest growth', f'{worst.slope:+.2f} MB/h', worst.name)
    yield _figure('recorded', f'{figures.recorded:.0f} MB', '')


def _figure(label: str, value: str, note: str) -> str:
    return (
        f'<div class="figure"><div class="label">{html.escape(label)}</div>'
        f'<div class="value">{html.escape(value)}</div>'
        f'<div class="note">{html.escape(note)}</div></div>'
    )


def _card(title: str, note: str, content: str) -> str:
    return f'<section class="card"><h2>{title}<span>{note}</span></h2>{content}</section>'


def _table(table: ReportTable) -> str:
    head = ''.join(f'<th>{html.escape(name)}</th>' for name, _ in table.columns)
    rows = ''.join(
        f'<tr class="{"bad" if row.bad else ""}">'
        + ''.join(f'<td>{html.escape(cell.strip("`"))}</td>' for cell in row.cells)
        + '</tr>'
        for row in table.rows
    )
    return (
        f'<section class="card"><h2>{html.escape(table.title)}</h2><div class="scroll"><table>'
        f'<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div></section>'
    )


def _histogram(figures: SoakFigures) -> str:
    """Both axes logarithmic: rare and late messages are what matters."""
    loops = [loop for loop in figures.loops if loop.late.size]
    if not loops:
        return ''
    low, high = 1e-5, max(1e-2, *(1.2 * loop.worst for loop in loops))
    edges = np.geomspace(low, high, BINS + 1)
    counts = [np.histogram(np.clip(loop.late, low, high), edges)[0] for loop in loops]
    top = 10.0 ** np.ceil(np.log10(max(int(count.max()) for count in counts) + 1))

    def x(value: float) -> float:
        return float(LEFT + (WIDTH - LEFT) * np.log(value / low) / np.log(high / low))

    def y(count: float) -> float:
        share = np.log10(max(count, 0.5) / 0.5) / np.log10(top / 0.5)
        return float(HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * share)

    parts = [_across(y(10.0**power), f'{10**power}') for power in range(int(np.log10(top)) + 1)]
    parts += [_below(x(1e-3 * ms), f'{ms:g} ms') for ms in MARKS if low <= 1e-3 * ms <= high]
    for number, count in enumerate(counts):
        steps = [f'M{x(edges[0]):.1f},{y(0):.1f}']
        for first, last, value in zip(edges[:-1], edges[1:], count, strict=True):
            steps.append(f'L{x(first):.1f},{y(value):.1f}L{x(last):.1f},{y(value):.1f}')
        steps.append(f'L{x(edges[-1]):.1f},{y(0):.1f}Z')
        colour = COLOURS[number]
        parts.append(f'<path d="{"".join(steps)}" fill="{colour}" fill-opacity="0.25" stroke="{colour}"/>')
    parts.append(_goal_line(x(LATE), f'{1e3 * LATE:g} ms'))
    return _legend([loop.name for loop in loops]) + _svg(parts)


def _lateness(figures: SoakFigures) -> str:
    series = [(loop.name, *_worst_of_parts(loop)) for loop in figures.loops if loop.late.size]
    return _lines(series, figures.duration, lambda value: f'{value:g} ms', goal=1e3 * LATE)


def _worst_of_parts(loop: LoopFigures) -> tuple[Array, Array]:
    parts = min(MOST_POINTS, loop.late.size)
    starts = np.linspace(0, loop.late.size, parts, endpoint=False).astype(int)
    return loop.due[starts], 1e3 * np.maximum.reduceat(loop.late, starts)


def _memory(figures: SoakFigures) -> str:
    series = [(one.name, one.time, one.megabytes - one.megabytes[0]) for one in figures.memory]
    return _lines(series, figures.duration, lambda value: f'{value:g} MB')


def _lines(
    series: Sequence[tuple[str, Array, Array]],
    duration: float,
    name: Callable[[float], str],
    goal: float | None = None,
) -> str:
    if not series:
        return ''
    low = min(0.0, *(float(values.min()) for _, _, values in series))
    high = max(goal or 0.0, 1.0, *(float(values.max()) for _, _, values in series)) * 1.05

    def x(time: float) -> float:
        return float(LEFT + (WIDTH - LEFT) * time / max(duration, 1.0))

    def y(value: float) -> float:
        return float(HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * (value - low) / (high - low))

    step = _nice((high - low) / 4.0)
    parts = [
        _across(y(value), name(round(value, 6)))
        for value in np.arange(np.ceil(low / step) * step, high, step)
    ]
    minutes = _nice(duration / 60.0 / 8.0)
    parts += [_below(x(60.0 * at), f'{at:g} min') for at in np.arange(0.0, duration / 60.0, minutes).round(6)]
    for number, (_, times, values) in enumerate(series):
        points = ' '.join(f'{x(time):.1f},{y(value):.1f}' for time, value in zip(times, values, strict=True))
        colour = COLOURS[number % len(COLOURS)]
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.4"/>')
    if goal is not None:
        parts.append(f'<line class="goal" x1="{LEFT}" x2="{WIDTH}" y1="{y(goal):.1f}" y2="{y(goal):.1f}"/>')
    return _legend([label for label, _, _ in series]) + _svg(parts)


def _nice(value: float) -> float:
    """1, 2 or 5 times a power of ten, not below a value."""
    power = 10.0 ** np.floor(np.log10(max(value, 1e-9)))
    return float(next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= value))


def _across(y: float, text: str) -> str:
    return (
        f'<line class="grid" x1="{LEFT}" x2="{WIDTH}" y1="{y:.1f}" y2="{y:.1f}"/>'
        f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{text}</text>'
    )


def _below(x: float, text: str) -> str:
    anchor = 'end' if x > WIDTH - 40 else 'middle'
    return f'<text x="{x:.1f}" y="{HEIGHT - 10}" text-anchor="{anchor}">{text}</text>'


def _goal_line(x: float, text: str) -> str:
    return (
        f'<line class="goal" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>'
        f'<text class="goal-text" x="{x + 5:.1f}" y="{TOP + 12}">{text}</text>'
    )


def _legend(names: Sequence[str]) -> str:
    items = ''.join(
        f'<span><i style="background:{COLOURS[number % len(COLOURS)]}"></i>{html.escape(name)}</span>'
        for number, name in enumerate(names)
    )
    return f'<div class="legends">{items}</div>'


def _svg(parts: Iterable[str]) -> str:
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img">{"".join(parts)}</svg>'

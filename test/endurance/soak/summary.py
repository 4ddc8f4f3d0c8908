"""The figures of a long run as tables."""

from typing import Final

from robots_controller.report.tables import ReportTable, Row
from robots_controller.terminal_table import Kind

from .figures import LARGEST_SLOPE, LATE, MEANINGFUL, MOST_MISSED, SoakFigures

LOOPS: Final[tuple[tuple[str, Kind], ...]] = (
    ('messages of', 'text'),
    ('sent', 'number'),
    ('median ms', 'number'),
    ('p99 ms', 'number'),
    ('p99.9 ms', 'number'),
    ('p99.99 ms', 'number'),
    ('worst ms', 'number'),
    (f'more than {1e3 * LATE:g} ms late', 'number'),
    ('gaps', 'number'),
    ('longest gap ms', 'number'),
)
MEMORY: Final[tuple[tuple[str, Kind], ...]] = (
    ('process', 'text'),
    ('first MB', 'number'),
    ('last MB', 'number'),
    ('slope MB/h', 'number'),
)


def loop_table(figures: SoakFigures) -> ReportTable:
    """Lateness of the loops."""
    rows = []
    for loop in figures.loops:
        gaps, missed = loop.gaps, loop.missed > MOST_MISSED * loop.late.size
        cells = (
            f'`{loop.name}`',
            str(loop.late.size),
            *(f'{1e3 * value:.3f}' for value in loop.percentiles),
            f'{1e3 * loop.worst:.2f}',
            str(loop.missed),
            str(gaps.size),
            f'{1e3 * gaps.max():.0f}' if gaps.size else '-',
        )
        rows.append(Row(cells, bad=missed, trends={7: 'worse'} if missed else {}))
    return ReportTable('How late messages were sent after they were due, at 250 Hz', LOOPS, tuple(rows))


def memory_table(figures: SoakFigures) -> ReportTable:
    """Memory of the processes."""
    rows = []
    for one in figures.memory:
        bad = figures.duration >= MEANINGFUL and one.slope > LARGEST_SLOPE
        cells = (
            f'`{one.name}`',
            f'{one.megabytes[0]:.1f}',
            f'{one.megabytes[-1]:.1f}',
            f'{one.slope:+.2f}',
        )
        rows.append(Row(cells, bad=bad, trends={3: 'worse'} if bad else {}))
    note = '' if figures.duration >= MEANINGFUL else ' (a short run: slopes say little)'
    return ReportTable(f'Memory that processes share with no file{note}', MEMORY, tuple(rows))


def closing_line(figures: SoakFigures) -> str:
    """One line for all."""
    missed = len(figures.missed_goals)
    verdict = f'{missed} goals missed' if missed else 'all goals met'
    return (
        f'{figures.duration / 60.0:.1f} minutes: {figures.runs} runs of the program, '
        f'jogged {figures.jogs} times, {figures.inputs} changes of inputs, '
        f'{figures.recorded:.0f} MB recorded; {verdict}'
    )

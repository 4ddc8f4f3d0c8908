"""LineTimes: where the cycle time goes, line by line of the program."""

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import Final, Literal

from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.report.recorded_run import RecordedRun

Activity = Literal['moving', 'waiting', 'io']
ACTIVITIES: Final[Mapping[Activity, str]] = {'moving': 'moving', 'waiting': 'waiting', 'io': 'I/O'}
"""Their names in tables."""
BEFORE: Final = '(before the first line)'
_IO_CALL: Final = re.compile(
    r'\b(' + '|'.join(name for name in LUA_FUNCTIONS if re.search(r'(In|Out)put', name)) + r')\b'
)


@dataclass(frozen=True)
class Span:
    """What a span of time was used for.

    Attributes:
        start: s.
        end: s.
        file: Program that it belongs to.
        line: Line there; 0 for none.
        activity: 'moving': a motion was under way; 'io': the program was at a line that reads or switches
            inputs and outputs; 'waiting': all else.
    """

    start: float
    end: float
    file: str
    line: int
    activity: Activity

    @property
    def duration(self) -> float:
        """Length, s."""
        return self.end - self.start


@dataclass(frozen=True)
class LineTime:
    """Times of a line, all its visits together.

    Attributes:
        file: Program or subprogram.
        line: From 1.
        source: The line's text.
        visits: How often the program came there.
        moving: s in which a motion of this line was under way.
        waiting: s of waits, planning and computing.
        io: s in which it waited for inputs, or switched outputs.
    """

    file: str
    line: int
    source: str
    visits: int
    moving: float
    waiting: float
    io: float

    @property
    def total(self) -> float:
        """All together, s."""
        return self.moving + self.waiting + self.io


def time_spans(run: RecordedRun) -> tuple[Span, ...]:
    """What every moment of a run was used for, in order and without gaps.

    A motion's time belongs to the line that commanded it, also while the program is at a later one already.
    """
    motions = [motion for motion in run.motions if motion.moved]
    cuts = {0.0, run.duration}
    cuts.update(point.time for point in run.program)
    cuts.update(time for motion in motions for time in (motion.start, motion.end))
    edges = sorted(cut for cut in cuts if 0.0 <= cut <= run.duration)
    times = [point.time for point in run.program]
    starts = [motion.start for motion in motions]
    spans: list[Span] = []
    for start, end in pairwise(edges):
        middle = 0.5 * (start + end)
        latest = bisect_right(starts, middle) - 1
        under_way = motions[latest] if latest >= 0 and middle < motions[latest].end else None
        index = bisect_right(times, middle) - 1
        activity: Activity = 'waiting'
        if under_way is not None:
            file, line, activity = under_way.file, under_way.line, 'moving'
        elif index < 0:
            file, line = '', 0
        else:
            point = run.program[index]
            file, line = point.file, point.line
            activity = 'io' if _IO_CALL.search(point.source) else 'waiting'
        spans.append(Span(start, end, file, line, activity))
    return tuple(_joined(spans))


def line_times(run: RecordedRun, spans: Iterable[Span]) -> tuple[LineTime, ...]:
    """Times of all lines that a run came to, of its `time_spans`, in the program's order.

    Their sum is the run's duration.
    """
    sources = {(point.file, point.line): point.source for point in run.program if point.line}
    spent: dict[tuple[str, int], dict[Activity, float]] = {}
    visits = Counter(place for place, _ in groupby(_places(run)))
    for span in spans:
        times = spent.setdefault((span.file, span.line), dict.fromkeys(ACTIVITIES, 0.0))
        times[span.activity] += span.duration
    for place in visits:  # lines that took no time to speak of
        spent.setdefault(place, dict.fromkeys(ACTIVITIES, 0.0))
    files = list(dict.fromkeys(file for file, _ in spent))
    return tuple(
        LineTime(
            file,
            line,
            sources.get((file, line), '') if line else BEFORE,
            max(1, visits[file, line]),
            **spent[file, line],
        )
        for file, line in sorted(spent, key=lambda place: (files.index(place[0]), place[1]))
    )


def _places(run: RecordedRun) -> Iterable[tuple[str, int]]:
    return ((point.file, point.line) for point in run.program if point.line and point.time <= run.duration)


def _joined(spans: Iterable[Span]) -> Iterable[Span]:
    """Join neighbouring spans of the same line and activity."""
    for _, group in groupby(spans, key=lambda span: (span.file, span.line, span.activity)):
        first, *others = group
        yield replace(first, end=others[-1].end) if others else first

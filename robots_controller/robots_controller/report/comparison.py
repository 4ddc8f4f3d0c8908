"""Comparison of two runs: what got slower, and where."""

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Final

from robots_controller.report.line_times import ACTIVITIES, LineTime
from robots_controller.report.motion_figures import MotionFigures
from robots_controller.report.run_report import RunReport


@dataclass(frozen=True)
class LineChange:
    """A line in two runs, None where only the other one has it, and the limits that decide its motions."""

    before: LineTime | None
    after: LineTime | None
    decided_before: str
    decided_after: str

    @property
    def line(self) -> LineTime:
        """The line, as it is in the second run if it is there."""
        line = self.after or self.before
        assert line is not None
        return line

    @property
    def difference(self) -> float:
        """Second minus first, s."""
        return _total(self.after) - _total(self.before)

    @property
    def activity(self) -> str:
        """What of its time changed most: moving, waiting or io."""

        def change(name: str) -> float:
            after, before = (0.0 if x is None else getattr(x, name) for x in (self.after, self.before))
            return float(abs(after - before))

        return max(ACTIVITIES, key=change)


@dataclass(frozen=True, eq=False)
class RunComparison:
    """Two runs of a program, with the changes line by line, in the order of the program."""

    before: RunReport
    after: RunReport
    changes: tuple[LineChange, ...]

    @property
    def difference(self) -> float:
        """Cycle time of the second minus that of the first, s."""
        return self.after.run.duration - self.before.run.duration

    @property
    def largest(self) -> tuple[LineChange, ...]:
        """The lines whose time changed, largest change first."""
        changed = [change for change in self.changes if abs(change.difference) >= NOTICED]
        return tuple(sorted(changed, key=lambda change: -abs(change.difference)))

    def describe(self) -> str:
        """One line for a person."""
        total = self.before.run.duration
        if abs(self.difference) < NOTICED:
            return f'as fast as before: {self.after.run.duration:.2f} s'
        word = 'slower' if self.difference > 0 else 'faster'
        return (
            f'{abs(self.difference):.2f} s {word} ({100.0 * self.difference / total:+.1f} %){self._where()}'
        )

    def _where(self) -> str:
        """Which lines changed most, for the end of a sentence."""
        if not self.largest:
            return ''
        most = self.largest[0]
        near = max(NOTICED, TIE * abs(most.difference))
        tied = [change for change in self.largest if abs(change.difference - most.difference) <= near]
        if len(tied) > MOST_NAMED:
            return f'; {len(tied)} lines changed by about {most.difference:+.2f} s each'
        if len(tied) > 1:
            *places, last = (str(change.line.line) for change in tied)
            return f'; lines {", ".join(places)} and {last} changed by about {most.difference:+.2f} s each'
        word = 'most of it' if most.difference / self.difference > MOST else 'the largest change'
        return f', {word} in line {most.line.line}: {most.difference:+.2f} s {most.activity}'


NOTICED: Final = 5e-3  # s; less than two periods of the controller
TIE: Final = 0.1  # of the largest change: smaller differences do not rank lines
MOST: Final = 0.5  # of the whole difference
MOST_NAMED: Final = 4  # lines


def compare_runs(before: RunReport, after: RunReport) -> RunComparison:
    """Compare two runs of a program or of two versions of it; lines are matched by their text."""
    first, second = before.lines, after.lines
    matcher = SequenceMatcher(None, [_key(line) for line in first], [_key(line) for line in second], False)
    changes: list[LineChange] = []

    def add(one: LineTime | None, other: LineTime | None) -> None:
        changes.append(LineChange(one, other, _decided(before.motions, one), _decided(after.motions, other)))

    for tag, i, i_end, j, j_end in matcher.get_opcodes():
        if tag == 'equal' or (tag == 'replace' and i_end - i == j_end - j):  # a line with other numbers
            for one, other in zip(first[i:i_end], second[j:j_end], strict=True):
                add(one, other)
        else:
            for line in first[i:i_end]:
                add(line, None)
            for line in second[j:j_end]:
                add(None, line)
    return RunComparison(before, after, tuple(changes))


def _key(line: LineTime) -> tuple[str, str]:
    return line.file, line.source


def _decided(motions: Sequence[MotionFigures], line: LineTime | None) -> str:
    if line is None:
        return ''
    here = (m for m in motions if (m.motion.file, m.motion.line) == (line.file, line.line))
    return ', '.join(dict.fromkeys(m.deciding.describe() for m in here if m.deciding))


def _total(line: LineTime | None) -> float:
    return 0.0 if line is None else line.total

"""ProgramReporter: at once, and no faster than anyone reads."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from robots_controller.cell.program_reporter import BURST, RATE, ProgramReporter
from robots_controller.program.run_state import RunState
from robots_core.status import Level, Status


class Desk:
    """A program at a line, a clock, and what is reported."""

    def __init__(self) -> None:
        self.time = 0.0
        self.program = SimpleNamespace(
            run_state=RunState.RUNNING,
            runs=1,
            line=1,
            file='test.lua',
            line_file='test.lua',
            error=None,
            hold_reason='',
            call_stack='[]',
            source_line=lambda line: f'line({line})',
        )
        self.reports: list[tuple[RunState, Status]] = []
        self.reporter = ProgramReporter(
            self.program,  # type: ignore[arg-type]
            self,  # type: ignore[arg-type]  # nothing waits
            lambda *report: self.reports.append(report),
        )

    def now(self) -> float:
        return self.time

    def go_to(self, line: int) -> None:
        self.program.line = line
        self.reporter.line_changed()

    @property
    def lines(self) -> list[int]:
        return [status.values['line'] for _, status in self.reports]


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_a_line_is_reported_at_once_with_its_place(desk: Desk) -> None:
    desk.go_to(7)
    ((state, status),) = desk.reports
    assert (state, status.level, status.text) == (RunState.RUNNING, Level.OK, 'test.lua: RUNNING')
    assert status.values == {
        'state': 'RUNNING',
        'run': 1,
        'file': 'test.lua',
        'line': 7,
        'source': 'line(7)',
        'error': '',
    }
    assert not desk.reporter.due


def test_of_lines_that_change_too_fast_the_newest_is_reported_when_there_is_time(desk: Desk) -> None:
    for line in range(1000):
        desk.go_to(line)
    assert desk.lines == list(range(int(BURST)))
    assert desk.reporter.due
    desk.time += 1.0 / RATE
    desk.reporter.report_in_time()
    assert desk.lines[-1] == 999
    desk.time += 1.0 / RATE
    desk.reporter.report_in_time()
    desk.reporter.report_if_due()
    assert len(desk.reports) == BURST + 1  # nothing has changed


def test_no_more_are_reported_than_the_rate_allows(desk: Desk) -> None:
    seconds, changes = 4.0, 8000
    for line in range(changes):
        desk.time = line * seconds / changes
        desk.go_to(line)
    assert len(desk.reports) == pytest.approx(BURST + seconds * RATE, abs=1)


def test_a_change_that_was_left_out_can_be_reported_at_the_end(desk: Desk) -> None:
    for line in range(100):
        desk.go_to(line)
    desk.reporter.report_if_due()
    assert desk.lines[-1] == 99


def test_a_motion_is_reported_with_its_own_line_until_the_next(desk: Desk) -> None:
    desk.go_to(9)
    desk.reporter.motion_sent('5.0', 'part.lua', 3)
    expected = {'motion': '5.0', 'motion_file': 'part.lua', 'motion_line': 3}
    for _ in range(2):
        values = desk.reports[-1][1].values
        assert values['line'] in (9, 10)
        assert expected.items() <= values.items()
        desk.go_to(10)


def test_why_a_program_was_held_or_not_opened_is_reported(desk: Desk) -> None:
    desk.reporter.open_error = 'test.lua:1: no Lua'
    desk.program.hold_reason = 'breakpoint'
    desk.reporter.report()
    _, status = desk.reports[-1]
    values = status.values
    assert status.level is Level.ERROR
    assert status.text == values['error'] == 'test.lua:1: no Lua'
    assert (values['hold'], values['stack']) == ('breakpoint', '[]')

"""Program and cell take turns, and time passes in the cell's turn alone."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest

from robots_controller.program.clock import Clock
from robots_controller.program.turn_clock import CALLS_PER_PERIOD, CALLS_PERIOD, NANOSECONDS
from robots_controller.simulation.simulated_clock import START, SimulatedClock

START_TIME = START / NANOSECONDS
PERIOD = CALLS_PERIOD


class Program:
    """A thread in the place of a Lua program."""

    def __init__(self, clock: SimulatedClock, work: Callable[[threading.Condition], None]) -> None:
        self.clock = clock
        self.condition = threading.Condition()
        self.ended = False

        def run() -> None:
            with self.condition:
                work(self.condition)
            self.ended = True
            clock.program_ended()

        self.thread = threading.Thread(target=run)
        self.thread.start()
        clock.program_started()


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock()


def test_it_is_a_clock(clock: SimulatedClock):
    as_clock: Clock = clock
    assert as_clock.now() == START_TIME


def test_a_waiting_program_goes_on_when_the_cell_lets_it(clock: SimulatedClock):
    seen: list[float] = []

    def work(condition: threading.Condition) -> None:
        for deadline in (1.0, None, 2.5):
            clock.wait(condition, None if deadline is None else START_TIME + deadline)
            seen.append(clock.elapsed)

    program = Program(clock, work)
    assert clock.waiting
    assert clock.deadline == START_TIME + 1.0
    clock.nanoseconds = 1_000_000_000
    clock.yield_to_program()
    assert clock.deadline == float('inf')
    clock.nanoseconds = 1_250_000_000
    clock.yield_to_program()
    assert clock.deadline == START_TIME + 2.5
    assert seen == [1.0, 1.25]
    clock.nanoseconds = 2_500_000_000
    clock.yield_to_program()
    assert program.ended
    assert not clock.waiting


def test_a_notification_alone_gives_no_turn(clock: SimulatedClock):
    program = Program(clock, lambda condition: clock.wait(condition, None))
    for _ in range(100):
        with program.condition:
            program.condition.notify_all()
    assert clock.waiting
    assert not program.ended
    clock.yield_to_program()
    assert program.ended


def test_a_wait_shorter_than_the_rounding_of_time_ends(clock: SimulatedClock):
    clock.nanoseconds = 20_000_000_000
    Program(clock, lambda condition: clock.wait(condition, START_TIME + 20.0 + 1e-18))
    assert clock.deadline > clock.now()
    clock.yield_to_program()


def test_a_program_that_only_calls_lets_a_period_pass(clock: SimulatedClock):
    def work(_: threading.Condition) -> None:
        for _ in range(CALLS_PER_PERIOD + 1):
            clock.called()

    program = Program(clock, work)
    assert clock.deadline == START_TIME + PERIOD
    assert not program.ended
    clock.nanoseconds = 4_000_000
    clock.yield_to_program()
    assert program.ended


def test_calls_at_different_times_do_not_add_up(clock: SimulatedClock):
    def work(condition: threading.Condition) -> None:
        for number in range(1, 4):
            for _ in range(CALLS_PER_PERIOD):
                clock.called()
            clock.wait(condition, START_TIME + number)

    Program(clock, work)
    for second in range(1, 4):
        assert clock.deadline == START_TIME + second
        clock.nanoseconds = second * 1_000_000_000
        clock.yield_to_program()


def test_after_the_end_nobody_waits(clock: SimulatedClock):
    def work(condition: threading.Condition) -> None:
        for _ in range(3):
            clock.wait(condition, None)

    program = Program(clock, work)
    clock.end()
    program.thread.join(120.0)
    assert program.ended

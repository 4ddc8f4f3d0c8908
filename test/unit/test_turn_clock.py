"""TurnClock: program and cell take turns, whatever the threads do."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.program.turn_clock import CALLS_PER_PERIOD, CALLS_PERIOD, NANOSECONDS, TurnClock

PERIOD = CALLS_PERIOD


class Turns:
    """A clock with its time, and who did what when."""

    def __init__(self) -> None:
        self.stamp = 1_000_000_000
        self.clock = TurnClock(lambda: self.stamp)
        self.changed = threading.Condition()
        self.log: list[tuple[str, int]] = []

    def note(self, who: str) -> None:
        self.log.append((who, self.stamp))

    @contextmanager
    def program(self, work: Callable[[], None]) -> Iterator[None]:
        """Run a program in its thread; the cell's turn begins when it waits or has ended."""

        def run() -> None:
            work()
            self.clock.program_ended()

        thread = threading.Thread(target=run)
        thread.start()
        self.clock.program_started()
        try:
            yield
        finally:
            self.clock.end()
            thread.join()

    def wait(self, seconds: float | None = None) -> None:
        with self.changed:
            self.clock.wait(self.changed, None if seconds is None else self.clock.now() + seconds)


@pytest.fixture
def turns() -> Turns:
    return Turns()


def test_time_passes_for_a_program_only_while_it_waits(turns: Turns) -> None:
    def work() -> None:
        for _ in range(3):
            turns.note('program')
            turns.wait(0.5)

    clock = turns.clock
    with turns.program(work):
        while clock.waiting:
            turns.note('cell')
            assert clock.deadline == pytest.approx(clock.now() + 0.5)
            turns.stamp = int(clock.deadline_stamp)
            clock.yield_to_program()
    begin = 1_000_000_000
    assert turns.log == [(who, begin + k * 500_000_000) for k in range(3) for who in ('program', 'cell')]


def test_a_wait_without_end_is_one_for_a_change(turns: Turns) -> None:
    with turns.program(turns.wait):
        assert turns.clock.waiting
        assert turns.clock.deadline == turns.clock.deadline_stamp == math.inf
        turns.clock.yield_to_program()
        assert not turns.clock.waiting


def test_no_wait_is_shorter_than_a_nanosecond(turns: Turns) -> None:
    with turns.program(lambda: turns.wait(0.0)):
        assert turns.clock.deadline_stamp == turns.stamp + 1


def test_a_program_that_never_waits_lets_a_period_pass_now_and_then(turns: Turns) -> None:
    def work() -> None:
        for _ in range(3 * CALLS_PER_PERIOD + 3):
            turns.clock.called()

    periods = 0
    with turns.program(work):
        while turns.clock.waiting:
            assert turns.clock.deadline == pytest.approx(turns.clock.now() + PERIOD)
            turns.stamp = int(turns.clock.deadline_stamp)
            periods += 1
            turns.clock.yield_to_program()
    assert periods == 3


def test_at_the_end_no_wait_lasts(turns: Turns) -> None:
    def work() -> None:
        for seconds in (None, 1e9, None):
            turns.wait(seconds)
        turns.note('program')

    with turns.program(work):
        assert not turns.log
    assert turns.log == [('program', 1_000_000_000)]


@given(st.integers(0, 10**18), st.floats(1e-9, 1e6))
def test_at_the_stamp_of_a_deadline_it_is_over_and_not_a_nanosecond_before(start: int, wait: float) -> None:
    clock = TurnClock(lambda: start)
    clock.deadline = clock.now() + wait
    stamp = int(clock.deadline_stamp)
    assert stamp / NANOSECONDS >= clock.deadline
    if start < 10**15:  # later, a double does not hold nanoseconds
        assert (stamp - 2) / NANOSECONDS < clock.deadline


def test_a_program_begins_in_a_turn_of_its_own_at_the_instant_in_which_it_was_started(turns: Turns) -> None:
    def work() -> None:
        turns.clock.program_begins()
        turns.note('program')

    with turns.program(work):
        turns.note('cell')
        assert turns.clock.waiting
        assert turns.clock.deadline_stamp == turns.stamp
        turns.clock.yield_to_program()
    assert turns.log == [('cell', 1_000_000_000), ('program', 1_000_000_000)]

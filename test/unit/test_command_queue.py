"""The book of commanded motions: chains, what runs, and what a failure takes with it."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_planning import MotionSettings, Trajectory
from robots_planning.command_queue import LONGEST_CHAIN, CommandQueue, QueuedCommand, RunningMotion
from robots_planning.motion_kinds import JOINT

STOPS, BLENDS = MotionSettings(), MotionSettings(blend_zone=0.01)
JOINT_BLENDS = MotionSettings(joint_blend_zone=0.1)


def order(number: int, how: MotionSettings = STOPS, received: float | None = None) -> QueuedCommand:
    at = float(number) if received is None else received
    return QueuedCommand(str(number), JOINT, np.zeros(2), how, at)


def running(*ids: str) -> RunningMotion:
    still = np.zeros((2, 2))
    ends = tuple(float(number) for number in range(1, len(ids) + 1))
    return RunningMotion(ids, Trajectory(np.array([0.0, ends[-1]]), still, still, still), ends)


@given(st.lists(st.sampled_from([STOPS, BLENDS, JOINT_BLENDS]), max_size=3 * LONGEST_CHAIN))
@settings(max_examples=60, deadline=None)
def test_every_command_is_planned_once_in_its_order_and_a_chain_ends_where_it_stops(
    kinds: list[MotionSettings],
) -> None:
    book = CommandQueue()
    chains = []
    for number, how in enumerate(kinds):
        chains.append(book.hold(order(number, how)))
        assert book.knows(str(number))
    chains.append(book.release())
    assert [item.id for chain in chains for item in chain] == [str(n) for n in range(len(kinds))]
    for chain in chains:
        assert len(chain) <= LONGEST_CHAIN
        assert all(item.settings.blends for item in chain[:-1])
    for chain in chains[:-1]:
        assert not chain or not chain[-1].settings.blends or len(chain) == LONGEST_CHAIN
    assert book.release() == ()


def test_an_order_is_known_until_it_is_refused_or_over() -> None:
    book = CommandQueue()
    for number in (1, 2, 3):
        book.hold(order(number))
    book.refused('1')
    assert [book.knows(id_) for id_ in '123'] == [False, True, True]
    assert book.planned(running('2', '3'), book.failures)
    assert book.ended('2', ok=True, at=9.0) is None  # a chain is known by its last command
    motion = book.ended('3', ok=True, at=9.0)
    assert motion is not None
    assert motion.ids == ('2', '3')
    assert motion.id == '3'
    assert not book.knows('2')
    assert not book.knows('3')


def test_motions_run_in_the_order_in_which_they_were_planned() -> None:
    book = CommandQueue()
    first, second = running('1'), running('2')
    assert book.planned(first, 0)
    assert book.planned(second, 0)
    assert book.running == (first, second)
    book.ended('1', ok=True, at=5.0)
    assert book.running == (second,)


def test_a_failure_takes_with_it_what_was_commanded_before_it_ended() -> None:
    book = CommandQueue()
    for number in (1, 2, 3):
        book.hold(order(number))
    book.planned(running('1'), book.failures)
    book.planned(running('2'), book.failures)
    failures = book.failures
    assert book.ended('1', ok=False, at=3.5) is not None
    assert book.running == ()
    assert not book.knows('2')
    assert 'given up with motion 1 before it' in book.given_up([order(3)])
    assert book.given_up([order(4)]) == ''
    assert book.given_up([order(3), order(4)]) != ''  # a chain begins with its first command
    # A plan that was under way meanwhile starts where the robot will not be.
    assert not book.planned(running('3'), failures)
    assert book.planned(running('4'), book.failures)


def test_a_late_result_of_an_older_stop_does_not_revive_what_a_newer_one_voided() -> None:
    book = CommandQueue()
    book.planned(running('1'), 0)
    book.planned(running('2'), 0)
    book.ended('1', ok=False, at=8.0)
    book.planned(running('3'), book.failures)
    book.ended('3', ok=False, at=6.0)
    assert book.given_up([order(7)]) != ''
    assert book.given_up([order(9)]) == ''


def test_a_replaced_motion_is_forgotten_but_no_failure() -> None:
    book = CommandQueue()
    old, new = running('1'), running('2')
    book.hold(order(1))
    book.hold(order(2))
    book.planned(old, 0)
    book.planned(new, 0)
    book.replaced(old)
    assert book.running == (new,)
    assert book.failures == 0
    assert not book.knows('1')
    assert book.knows('2')
    assert book.ended('1', ok=False, at=9.0) is None  # its own result changes nothing
    assert book.failures == 0


def test_a_lost_controller_forgets_what_runs_and_nothing_else() -> None:
    book = CommandQueue()
    book.hold(order(1))
    book.hold(order(2, BLENDS))
    book.planned(running('1'), 0)
    book.forget()
    assert book.running == ()
    assert not book.knows('1')
    assert book.knows('2')
    assert [item.id for item in book.release()] == ['2']


def test_threads_lose_no_command() -> None:
    book = CommandQueue()
    planned: list[str] = []
    start = threading.Barrier(4)

    def send(first: int) -> None:
        start.wait()
        for number in range(first, first + 50):
            how = BLENDS if number % 3 else STOPS
            planned.extend(item.id for item in book.hold(order(number, how)))

    threads = [threading.Thread(target=send, args=(100 * index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    planned.extend(item.id for item in book.release())
    assert sorted(map(int, planned)) == [100 * index + k for index in range(4) for k in range(50)]


@pytest.mark.parametrize('ok', [True, False])
def test_the_end_of_a_foreign_motion_is_none_of_its_business(ok: bool) -> None:  # noqa: FBT001
    book = CommandQueue()
    book.planned(running('1'), 0)
    assert book.ended('77', ok=ok, at=9.0) is None
    assert book.failures == 0
    assert len(book.running) == 1

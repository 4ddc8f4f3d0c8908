"""The queue of commanded motions: chains, what runs, and what a failure takes with it."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_planning import MotionSettings, Trajectory
from robots_planning.commands.command_queue import WINDOW, CommandQueue
from robots_planning.commands.motion_plan import CommandChain, MotionPlan, QueuedCommand
from robots_planning.motion_kinds import JOINT
from robots_planning.pathplanning import PlannedMotion
from robots_planning.verification.trajectory_verification import VerificationReport

STOPS, BLENDS = MotionSettings(), MotionSettings(blend_zone=0.01)
JOINT_BLENDS = MotionSettings(joint_blend_zone=0.1)


def order(number: int, how: MotionSettings = STOPS, received: float | None = None) -> QueuedCommand:
    at = float(number) if received is None else received
    return QueuedCommand(str(number), JOINT, np.zeros(2), how, at)


def running(*ids: str) -> MotionPlan:
    still = np.zeros((2, 2))
    ends = {id_: float(number) for number, id_ in enumerate(ids, 1)}
    end = ends[ids[-1]]
    trajectory = Trajectory(np.array([0.0, end]), still, still, still)
    motion = PlannedMotion(trajectory, None, cast('VerificationReport', None))
    return MotionPlan(ids[-1], motion, ends, '')


@given(st.lists(st.sampled_from([STOPS, BLENDS, JOINT_BLENDS]), max_size=3 * WINDOW))
@settings(max_examples=60, deadline=None)
def test_every_command_is_planned_once_in_its_order_and_a_chain_ends_where_it_stops(
    kinds: list[MotionSettings],
) -> None:
    queue = CommandQueue()
    held = []
    for number, how in enumerate(kinds):
        held.append(queue.hold(order(number, how)))
        assert queue.holds(str(number))
    held.append(queue.release())
    chains = [chain for chain in held if chain is not None]
    assert [item.id for chain in chains for item in chain.commands] == [str(n) for n in range(len(kinds))]
    for chain in chains:
        assert len(chain.commands) <= WINDOW
        assert all(item.settings.blends for item in chain.commands[:-1])
    for chain in chains[:-1]:
        assert chain.goes_on == chain.commands[-1].settings.blends
    assert not chains or not chains[-1].goes_on
    assert queue.release() is None


def test_a_long_chain_is_planned_in_windows_with_half_of_each_as_the_stop_of_the_one_before() -> None:
    queue = CommandQueue()
    chains = [queue.hold(order(number, BLENDS)) for number in range(2 * WINDOW + 1)]
    chains.append(queue.hold(order(2 * WINDOW + 1)))
    sizes = [(len(chain.commands), chain.goes_on) for chain in chains if chain is not None]
    assert sizes == [(WINDOW, True), (WINDOW // 2, True), (WINDOW // 2, True), (2, False)]


def test_a_motion_that_is_carried_on_leaves_its_last_commands_to_the_next_one() -> None:
    queue = CommandQueue()
    for number in (1, 2, 3, 4):
        queue.hold(order(number))
    first, second = running('1', '2', '3'), running('3', '4')
    queue.planned(replace(first, id='2'), 0)
    queue.planned(second, 0)
    ended = queue.ended('2', ok=True, at=9.0)
    assert ended is not None
    assert [*ended.ends] == ['1', '2']
    assert [queue.holds(id_) for id_ in '1234'] == [False, False, True, True]
    assert queue.running == (second,)


def test_an_order_is_known_until_it_is_refused_or_over() -> None:
    queue = CommandQueue()
    for number in (1, 2, 3):
        queue.hold(order(number))
    queue.refused('1')
    assert [queue.holds(id_) for id_ in '123'] == [False, True, True]
    assert queue.planned(running('2', '3'), queue.failures)
    assert queue.ended('2', ok=True, at=9.0) is None  # a chain is known by its last command
    motion = queue.ended('3', ok=True, at=9.0)
    assert motion is not None
    assert [*motion.ends] == ['2', '3']
    assert motion.id == '3'
    assert not queue.holds('2')
    assert not queue.holds('3')


def test_motions_run_in_the_order_in_which_they_were_planned() -> None:
    queue = CommandQueue()
    first, second = running('1'), running('2')
    assert queue.planned(first, 0)
    assert queue.planned(second, 0)
    assert queue.running == (first, second)
    queue.ended('1', ok=True, at=5.0)
    assert queue.running == (second,)


def test_a_failure_takes_with_it_what_was_commanded_before_it_ended() -> None:
    queue = CommandQueue()
    for number in (1, 2, 3):
        queue.hold(order(number))
    queue.planned(running('1'), queue.failures)
    queue.planned(running('2'), queue.failures)
    failures = queue.failures
    assert queue.ended('1', ok=False, at=3.5) is not None
    assert queue.running == ()
    assert not queue.holds('2')
    assert 'given up with motion 1 before it' in queue.given_up([order(3)])
    assert queue.given_up([order(4)]) == ''
    assert queue.given_up([order(3), order(4)]) != ''  # a chain begins with its first command
    # A plan that was under way meanwhile starts where the robot will not be.
    assert not queue.planned(running('3'), failures)
    assert queue.planned(running('4'), queue.failures)


def test_a_late_result_of_an_older_stop_does_not_revive_what_a_newer_one_voided() -> None:
    queue = CommandQueue()
    queue.planned(running('1'), 0)
    queue.planned(running('2'), 0)
    queue.ended('1', ok=False, at=8.0)
    queue.planned(running('3'), queue.failures)
    queue.ended('3', ok=False, at=6.0)
    assert queue.given_up([order(7)]) != ''
    assert queue.given_up([order(9)]) == ''


def test_a_replaced_motion_is_forgotten_but_no_failure() -> None:
    queue = CommandQueue()
    old, new = running('1'), running('2')
    queue.hold(order(1))
    queue.hold(order(2))
    queue.planned(old, 0)
    queue.planned(new, 0)
    queue.replaced(old)
    assert queue.running == (new,)
    assert queue.failures == 0
    assert not queue.holds('1')
    assert queue.holds('2')
    assert queue.ended('1', ok=False, at=9.0) is None  # its own result changes nothing
    assert queue.failures == 0


def test_a_lost_controller_forgets_what_runs_and_nothing_else() -> None:
    queue = CommandQueue()
    queue.hold(order(1))
    queue.hold(order(2, BLENDS))
    queue.planned(running('1'), 0)
    queue.forget()
    assert queue.running == ()
    assert not queue.holds('1')
    assert queue.holds('2')
    chain = queue.release()
    assert chain is not None
    assert [item.id for item in chain.commands] == ['2']


def test_threads_lose_no_command() -> None:
    queue = CommandQueue()
    planned: list[str] = []
    start = threading.Barrier(4)

    def take(chain: CommandChain | None) -> None:
        planned.extend(() if chain is None else (item.id for item in chain.commands))

    def send(first: int) -> None:
        start.wait()
        for number in range(first, first + 50):
            how = BLENDS if number % 3 else STOPS
            take(queue.hold(order(number, how)))

    threads = [threading.Thread(target=send, args=(100 * index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    take(queue.release())
    assert sorted(map(int, planned)) == [100 * index + k for index in range(4) for k in range(50)]


@pytest.mark.parametrize('ok', [True, False])
def test_the_end_of_a_foreign_motion_is_none_of_its_business(ok: bool) -> None:  # noqa: FBT001
    queue = CommandQueue()
    queue.planned(running('1'), 0)
    assert queue.ended('77', ok=ok, at=9.0) is None
    assert queue.failures == 0
    assert len(queue.running) == 1

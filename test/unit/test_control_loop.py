"""ControlLoop: a mailbox that is emptied once per period, results and progress out."""

from __future__ import annotations

import numpy as np
import pytest

from robots_controller.control.control_loop import CANCELED
from robots_controller.control.controller import ControllerState
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.stops.faults import Fault
from robots_controller.control.stops.stop_latch import StopState
from robots_controller.control.streamed_reference import StreamPoint
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import CommandRefusedError, NotNowError, RobotsError

from .control_rig import GOAL, PERIOD, START, ControlRig
from .two_axes import quintic


@pytest.fixture
def rig() -> ControlRig:
    return ControlRig()


def test_requests_hold_from_the_next_period_on_and_in_their_order(rig: ControlRig) -> None:
    rig.loop.request('pause')
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    assert not rig.loop.controller.speed.paused
    rig.run(1)
    assert rig.loop.controller.speed.paused
    rig.run(100)
    np.testing.assert_array_equal(rig.q, START)
    rig.loop.request('resume')
    assert rig.run_until_result().ok
    np.testing.assert_allclose(rig.q, GOAL, atol=1e-12)


def test_motions_end_in_their_order(rig: ControlRig) -> None:
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.loop.follow(quintic(GOAL, START, 1.0), '2')
    assert [rig.run_until_result().id for _ in range(2)] == ['1', '2']
    np.testing.assert_allclose(rig.q, START, atol=1e-12)


def test_a_trajectory_that_starts_elsewhere_is_refused(rig: ControlRig) -> None:
    rig.loop.follow(quintic(GOAL, START, 1.0), '1')
    rig.run(1)
    (result,) = rig.results
    assert (result.id, result.ok) == ('1', False)
    np.testing.assert_array_equal(rig.q, START)


@pytest.mark.parametrize('paused', [False, True])
def test_a_cancellation_gives_up_all_motions_and_ends_a_pause(rig: ControlRig, paused: bool) -> None:  # noqa: FBT001
    rig.begin(paused=paused)
    rig.loop.follow(quintic(GOAL, START, 1.0), '2')
    rig.loop.request('cancel')
    results = [rig.run_until_result() for _ in range(2)]
    assert {result.id for result in results} == {'1', '2'}
    assert not any(result.ok for result in results)
    assert CANCELED in {result.message for result in results}
    assert not rig.loop.controller.speed.paused
    rig.run(100)
    rig.loop.follow(quintic(rig.q, GOAL, 1.0), '3')
    assert rig.run_until_result().ok


def test_a_cancellation_for_a_reason_leaves_a_pause(rig: ControlRig) -> None:
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run(100)
    rig.loop.request('pause')
    rig.loop.cancel('somebody came near')
    assert rig.run_until_result().message == 'somebody came near'
    assert rig.loop.controller.speed.paused


@pytest.mark.parametrize('paused', [False, True])
def test_a_stop_holds_until_its_reset_and_ends_a_pause(rig: ControlRig, paused: bool) -> None:  # noqa: FBT001
    rig.begin(paused=paused)
    rig.loop.stop('a person')
    assert rig.run_until_result().message == 'a person'
    rig.run(1)
    assert (rig.stops[-1].fault, rig.stops[-1].drives_on) == (Fault.STOP, True)
    rig.loop.follow(quintic(rig.q, GOAL, 1.0), '2')
    assert 'a person; ~/reset lets the robot move again' in rig.run_until_result().message
    rig.loop.reset()
    rig.loop.follow(quintic(rig.q, GOAL, 1.0), '3')
    assert rig.run_until_result().ok


def test_a_stop_of_a_robot_that_stands_holds_too(rig: ControlRig) -> None:
    rig.run(1)
    rig.loop.stop('a person')
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    assert not rig.run_until_result().ok
    rig.loop.reset()
    rig.loop.follow(quintic(START, GOAL, 1.0), '2')
    assert rig.run_until_result().ok


def test_an_emergency_stop_is_reported_and_holds_until_it_is_released_and_reset(rig: ControlRig) -> None:
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run(100)
    rig.loop.watch(Fault.EMERGENCY_STOP, 'button')
    assert rig.run_until_result().message == 'button'
    rig.run(10)
    assert [(state.reason, state.drives_on) for state in rig.stops] == [
        ('', True),
        ('button', True),
        ('button', False),
    ]
    with pytest.raises(RobotsError, match='cannot reset: button'):
        rig.loop.reset()
    rig.loop.watch(Fault.EMERGENCY_STOP, '')
    rig.run(1)
    rig.loop.follow(quintic(rig.q, GOAL, 1.0), '2')
    assert rig.run_until_result().message == 'button; ~/reset lets the robot move again'
    rig.loop.reset()
    rig.loop.follow(quintic(rig.q, GOAL, 1.0), '3')
    assert rig.run_until_result().ok
    assert rig.stops[-1] == StopState()


def test_no_motion_and_no_stream_starts_without_what_is_awaited(rig: ControlRig) -> None:
    rig.loop.wait_for('no sign of life of the guard yet')
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.loop.stream(StreamPoint(START, START, START, rig.now + PERIOD), '2')
    rig.run(1)
    assert [(result.ok, result.message) for result in rig.results] == [
        (False, 'no sign of life of the guard yet')
    ]
    assert rig.refusals == ['no sign of life of the guard yet']
    assert not rig.loop.controller.stops.latched
    rig.results.clear()
    rig.loop.wait_for('')
    rig.loop.follow(quintic(START, GOAL, 1.0), '3')
    assert rig.run_until_result().ok


@pytest.mark.parametrize('share', [1.0, 0.5])
def test_a_motion_does_not_go_on_after_its_controller_was_frozen(share: float) -> None:
    rig = ControlRig(watchdog=0.2, processor_share=lambda: share)
    rig.loop.pass_over(1000)  # of a robot that stands
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run(50)
    rig.loop.pass_over(round(0.19 / share / PERIOD))
    rig.run(50)
    assert not rig.results
    rig.loop.pass_over(round(0.21 / share / PERIOD))
    rig.run(1)
    (result,) = rig.results
    assert not result.ok
    assert result.message.startswith('the controller was held up for 0.')
    state = rig.stops[-1]
    assert (state.fault, state.drives_on) == (Fault.CONTROLLER_HELD_UP, False)
    rig.run(50)
    np.testing.assert_array_equal(rig.loop.controller.reference[1:], 0.0)
    rig.loop.reset()
    rig.run(1)
    rig.loop.follow(quintic(rig.q, GOAL, 1.0), '2')
    rig.run(1)
    assert not rig.loop.controller.standing


def test_half_the_override_takes_twice_the_time() -> None:
    durations = []
    for override in (1.0, 0.5):
        rig = ControlRig()
        rig.loop.set_override(override)
        rig.run(1000)
        before = rig.loop.cycle
        rig.loop.follow(quintic(START, GOAL, 1.0), '1')
        assert rig.run_until_result().ok
        durations.append((rig.loop.cycle - before) * PERIOD)
    # Smoothing and settling are not slower.
    assert durations[1] - durations[0] == pytest.approx(1.0, abs=0.01)


def test_progress_never_falls_and_both_ends_are_reported(rig: ControlRig) -> None:
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run_until_result()
    begin = rig.progresses.index(0.0)
    assert rig.progresses[-1] == 1.0
    assert (np.diff(rig.progresses[begin:]) > 0.0).all()


def test_progress_is_reported_as_often_as_it_is_wanted() -> None:
    rare, often = ControlRig(progress_every=10), ControlRig()
    for rig in (rare, often):
        rig.loop.follow(quintic(START, GOAL, 1.0), '1')
        rig.run_until_result()
        assert {0.0, 1.0} <= set(rig.progresses)
    assert set(rare.progresses) < set(often.progresses)
    assert len(rare.progresses) == pytest.approx(len(often.progresses) / 10, abs=3)


def test_a_point_that_is_refused_is_reported_and_moves_nothing(rig: ControlRig) -> None:
    rig.loop.stream(StreamPoint(np.array([9.0, 0.0]), START, START, rig.now + PERIOD), 's')
    rig.run(10)
    assert len(rig.refusals) == 1
    np.testing.assert_array_equal(rig.q, START)


def test_a_stream_is_followed_and_ends_with_a_result(rig: ControlRig) -> None:
    velocity = np.array([0.1, 0.0])
    begin = rig.now
    for _ in range(100):
        due = rig.now + PERIOD
        rig.loop.stream(StreamPoint(velocity * (due - begin), velocity, START, due), 's')
        rig.run(1)
    assert rig.loop.controller.state is ControllerState.STREAMING
    assert rig.q[0] == pytest.approx(0.1 * 100 * PERIOD, abs=0.005)
    assert rig.run_until_result().id == 's'


def test_cycles_of_a_robot_that_stands_may_be_left_out(rig: ControlRig) -> None:
    rig.run(100)
    rig.checks = 0
    rates = ControllerRates(1.0 / PERIOD, rig.loop.controller.settings.feedback_timeout)
    rig.loop.pass_over(3 * rates.holding_every)
    rig.run(rates.holding_every)
    assert rig.checks == 1
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    assert rig.run_until_result().ok


def test_a_release_is_the_reset_of_its_own_fault_alone(rig: ControlRig) -> None:
    loop, stops = rig.loop, rig.loop.controller.stops
    loop.watch(Fault.DEACTIVATED, 'not active')
    rig.run(5)
    assert not stops.state.drives_on
    with pytest.raises(NotNowError, match='cannot reset: not active'):
        loop.reset()
    loop.release(Fault.DEACTIVATED)
    rig.run(1)
    assert stops.state == StopState()

    loop.trip(Fault.EMERGENCY_STOP, 'pressed')
    loop.watch(Fault.DEACTIVATED, 'not active')
    rig.run(5)
    loop.release(Fault.DEACTIVATED)
    rig.run(1)
    assert stops.state.fault is Fault.EMERGENCY_STOP
    loop.reset()
    rig.run(1)
    assert stops.state == StopState()


def test_a_release_is_refused_while_the_robot_moves_or_another_cause_is_there(rig: ControlRig) -> None:
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run(50)
    with pytest.raises(NotNowError, match='still moving'):
        rig.loop.release(Fault.DEACTIVATED)
    assert rig.run_until_result().ok
    rig.loop.watch(Fault.EMERGENCY_STOP, 'pressed')
    rig.run(5)
    with pytest.raises(NotNowError, match='cannot reset: pressed'):
        rig.loop.release(Fault.DEACTIVATED)


@pytest.mark.parametrize(
    ('fault', 'stays'), [(Fault.COLLISION_GUARD_LOST, True), (Fault.CONTROLLER_LOST, False)]
)
def test_a_lost_node_stops_the_robot_and_some_must_be_back_before_a_reset(
    rig: ControlRig, fault: Fault, *, stays: bool
) -> None:
    rig.loop.node_changed(fault, 'silent')
    rig.run(5)
    assert rig.stops[-1].fault is fault
    if stays:
        with pytest.raises(NotNowError, match='cannot reset: silent'):
            rig.loop.reset()
    rig.loop.node_changed(fault, '')
    rig.run(1)
    rig.loop.reset()
    rig.run(1)
    assert rig.stops[-1].fault is None


@pytest.mark.parametrize('commander', [Commander.PENDANT, Commander.PROGRAM])
def test_a_lost_commander_loses_the_robot_and_that_of_a_pendant_stops(
    rig: ControlRig, commander: Commander
) -> None:
    authority = rig.loop.controller.speed.authority
    authority.commander = commander
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run(50)
    assert not rig.loop.lose_commander(Commander.REMOTE, 'silent')
    assert authority.commander is commander
    assert rig.loop.lose_commander(commander, 'silent')
    assert authority.commander is Commander.NOBODY
    result = rig.run_until_result()
    assert result.ok is (commander is Commander.PROGRAM)
    assert result.message == ('reached' if result.ok else 'silent')


def test_who_takes_the_robot_over_stops_it_unless_it_has_the_robot_already(rig: ControlRig) -> None:
    authority = rig.loop.controller.speed.authority
    rig.loop.take(Commander.REMOTE)
    rig.loop.follow(quintic(START, GOAL, 1.0), '1')
    rig.run(50)
    with pytest.raises(CommandRefusedError, match='PROGRAM'):
        rig.loop.take(Commander.PROGRAM)
    rig.loop.take_over(Commander.REMOTE)
    rig.run(50)
    assert not rig.results
    rig.loop.take_over(Commander.PROGRAM)
    assert authority.commander is Commander.PROGRAM
    result = rig.run_until_result()
    assert (result.ok, result.message) == (False, 'PROGRAM took the robot over')


def test_cycles_that_have_nothing_to_do_may_be_left_out() -> None:
    rig, other = ControlRig(), ControlRig()
    steps = 0
    while rig.loop.cycle < 200:
        rig.loop.pass_over(rig.loop.idle_cycles)
        rig.run(1)
        steps += 1
    other.run(rig.loop.cycle - other.loop.cycle)
    assert rig.checks == other.checks
    assert steps < 0.2 * rig.loop.cycle
    for one in (rig, other):
        one.begin(paused=True)
        one.loop.request('resume')
        assert one.run_until_result().ok
    np.testing.assert_array_equal(rig.q, other.q)
    assert rig.loop.cycle == other.loop.cycle


def test_a_request_and_a_moving_robot_leave_out_nothing() -> None:
    rig = ControlRig()
    rig.run(1)
    assert rig.loop.idle_cycles > 0
    rig.loop.set_override(0.5)
    assert rig.loop.idle_cycles == 0
    rig.run(1)
    assert rig.loop.idle_cycles > 0
    rig.begin(paused=True)
    assert rig.loop.idle_cycles == 0


def test_a_loop_that_waits_is_woken_by_whatever_comes() -> None:
    loop = ControlRig().loop
    assert not loop.wait(0.0)
    loop.request('pause')
    assert loop.wait(60.0)
    assert not loop.wait(0.0)
    loop.wake()
    assert loop.wait(60.0)

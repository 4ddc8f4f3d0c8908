"""DriverStop: a goal that fails is a stop of the robot until its brakes have closed."""

from __future__ import annotations

from robots_core.blocks.drives.driver_drives import FAILURE_SHOWN, DriverStop

LATER = 1.5 * FAILURE_SHOWN


def test_a_failed_goal_counts_until_the_brakes_have_closed_and_at_least_for_a_while() -> None:
    stop = DriverStop()
    assert not stop.reason
    assert stop.fail('refused', 10.0)
    assert not stop.recover(10.0 + 0.5 * FAILURE_SHOWN, braked=True)
    assert not stop.recover(10.0 + LATER, braked=False)
    assert stop.reason == 'refused'
    assert stop.recover(10.0 + LATER, braked=True)
    assert not stop.reason
    assert not stop.recover(10.0 + LATER, braked=True)


def test_the_same_failure_is_no_news_and_counts_anew() -> None:
    stop = DriverStop()
    stop.fail('refused', 10.0)
    assert not stop.fail('refused', 10.0 + LATER)
    assert not stop.recover(10.0 + LATER, braked=True)


def test_a_driver_whose_robot_does_not_run_has_stopped() -> None:
    stop = DriverStop()
    stop.follows = False
    assert stop.reason == 'the robot has stopped by itself'
    stop.fail('ended', 0.0)
    assert stop.reason == 'ended'
    stop.recover(LATER, braked=True)
    stop.follows = True
    assert not stop.reason

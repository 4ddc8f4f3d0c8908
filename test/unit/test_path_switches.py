"""PathSwitches: places on a path as progress of its planned time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.program.motion_command import Anchor, PathSwitch
from robots_controller.program.path_switches import PathSwitches
from robots_core.validation import Array

# 2 m along x in 4 s at constant speed.
TIME = np.linspace(0.0, 4.0, 401)
LINE = np.column_stack([0.5 * TIME, np.zeros_like(TIME), np.zeros_like(TIME)])
ROUNDING = 1e-9  # of an interpolation in double precision


def switch(anchor: Anchor, at: float, index: int = 1) -> PathSwitch:
    return PathSwitch(anchor, at, 'digital', index, 1.0)


def progress(one: PathSwitch, time: Array = TIME, r: Array = LINE) -> float:
    at = PathSwitches([([one], r[-1])], time, r).next_progress
    assert at is not None
    return at


@pytest.mark.parametrize(
    ('anchor', 'at', 'expected'),
    [
        ('distance_before_end', 0.5, 0.75),
        ('distance_before_end', 0.0, 1.0),
        ('distance_before_end', 9.0, 0.0),
        ('distance_after_start', 0.5, 0.25),
        ('distance_after_start', 9.0, 1.0),
        ('time_before_end', 1.0, 0.75),
        ('time_after_start', 1.0, 0.25),
        ('time_after_start', 9.0, 1.0),
    ],
)
def test_places_on_a_line(anchor: Anchor, at: float, expected: float):
    assert progress(switch(anchor, at)) == pytest.approx(expected, abs=ROUNDING)


@given(st.floats(0.01, 1.99))
def test_distances_from_both_ends_meet(distance: float):
    # Accelerated, so that time and way are not proportional.
    r = np.column_stack([2.0 * (TIME / 4.0) ** 2, 0.0 * TIME, 0.0 * TIME])
    start = progress(switch('distance_after_start', distance), r=r)
    assert start == pytest.approx(progress(switch('distance_before_end', 2.0 - distance), r=r), abs=1e-6)
    # The way is taken for straight between two points: in time that is at most one step of 0.01 s.
    assert start == pytest.approx(np.sqrt(distance / 2.0), abs=0.01 / 4.0)


def test_tool_that_stands_switches_by_time_alone():
    r = np.zeros_like(LINE)
    assert progress(switch('time_after_start', 1.0), r=r) == 0.25
    assert progress(switch('distance_before_end', 0.1), r=r) == 0.0


def test_switches_come_once_and_in_order():
    first, second = switch('distance_after_start', 0.5, 1), switch('distance_before_end', 0.5, 2)
    switches = PathSwitches([([second, first], LINE[-1])], TIME, LINE)
    assert switches.due(0.2) == []
    assert switches.due(0.3) == [first]
    assert switches.due(1.0) == [second]
    assert switches.due(1.0) == []
    assert switches.next_progress is None


def test_motions_of_a_chain_have_their_own_ends():
    corner = np.array([1.0, 0.0, 0.0])
    before, after = switch('distance_before_end', 0.25), switch('distance_after_start', 0.25, 2)
    switches = PathSwitches([([before], corner), ([after], LINE[-1])], TIME, LINE)
    assert switches.next_progress == pytest.approx(0.375, abs=ROUNDING)
    assert switches.due(0.5) == [before]
    assert switches.next_progress == pytest.approx(0.625, abs=ROUNDING)


def test_delay_is_that_of_the_speed_so_far():
    switches = PathSwitches([([switch('distance_before_end', 0.5)], LINE[-1])], TIME, LINE)
    assert switches.delay(10.0, 0.50) is None
    assert switches.delay(10.4, 0.55) == pytest.approx(0.2 * 8.0, abs=ROUNDING)  # half as fast as planned
    assert switches.delay(10.8, 0.55) is None  # held
    assert switches.delay(12.8, 0.80) == 0.0


def test_progress_that_comes_late_in_a_burst_does_not_hasten_the_switch():
    switches = PathSwitches([([switch('distance_before_end', 0.5)], LINE[-1])], TIME, LINE)
    switches.delay(10.0, 0.50)
    # Told a hundredth of the time after the one before: as fast as planned the robot is, and no faster.
    assert switches.delay(10.001, 0.55) == pytest.approx(0.2 * TIME[-1], abs=ROUNDING)

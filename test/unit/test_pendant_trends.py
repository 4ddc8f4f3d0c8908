"""Signals of a cell over the last minutes; without a browser and without ROS."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pendant_desk import READY
from robots_controller.pendant.pendant_state import PendantState, ShownIo
from robots_controller.pendant.trends import LONGEST, MOST_CHANNELS, MOST_POINTS, PERIOD, SAMPLES, Trends
from robots_core import Pose, load_robot_model

ROBOT = load_robot_model('cello_bot')  # its first axis slides
AXES = ROBOT.axes_data


def state(part: float) -> PendantState:
    q = np.array(ROBOT.home) + part
    io = ShownIo(values={'digital_inputs': (part, 0.0)}, labels={'digital_inputs': ('ready', '')})
    return replace(
        READY,
        q=q,
        q_dot=np.full(AXES.num_axes, part),
        torque=-part * np.array(AXES.effort),
        tool=Pose.identity(),
        tool_speed=part,
        distance=part,
        io=io,
    )


def test_signals_are_those_of_the_state_in_units_for_a_person() -> None:
    trends = Trends(AXES)
    trends.add(5.0, state(0.25))
    newest = {one.key: trends.curve(one.key, 10.0)[1] for one in trends.signals}
    assert newest['position 0'] == pytest.approx([1e3 * (ROBOT.home[0] + 0.25)])
    assert newest['position 1'] == pytest.approx([np.degrees(ROBOT.home[1] + 0.25)])
    assert newest['speed 1'] == pytest.approx([np.degrees(0.25)])
    assert newest['torque 2'] == pytest.approx([25.0])
    assert newest['tool_speed'] == newest['distance'] == pytest.approx([250.0])
    assert newest['digital_input.1'] == pytest.approx([0.25])
    names = {one.key: (one.name, one.unit) for one in trends.signals}
    assert names['position 0'] == (AXES.names[0], 'mm')
    assert names['digital_input.1'] == ('1 ready', '')
    assert names['digital_input.2'] == ('2', '')


def test_what_is_not_measured_has_no_curve() -> None:
    trends = Trends(AXES)
    assert trends.curve('position 0', 10.0)[0].size == 0
    trends.add(0.0, PendantState())
    for one in trends.signals:
        assert one.key == 'tool_speed' or trends.curve(one.key, 10.0)[1].size == 0
    assert trends.curve('unknown', 10.0)[0].size == 0


def test_what_is_too_large_for_a_curve_is_left_out() -> None:
    trends = Trends(AXES)
    for time, distance in ((0.0, 0.5), (1.0, 1e36), (2.0, 1e308)):
        trends.add(time, replace(state(0.25), distance=distance))
    assert trends.curve('distance', 10.0)[1] == pytest.approx([500.0])


@pytest.mark.parametrize('count', [1, 7, SAMPLES, SAMPLES + 1, 3 * SAMPLES + 5])
def test_the_last_minutes_are_kept_in_bounded_memory(count: int) -> None:
    trends = Trends(AXES)
    for number in range(count):
        trends.add(PERIOD * number, replace(READY, distance=1e-3 * number))
    assert len(trends._samples) == min(count, SAMPLES)
    times, values = trends.curve('distance', LONGEST)
    assert 0 < times.size <= MOST_POINTS
    assert times[-1] == 0.0
    assert values[-1] == count - 1  # the newest is always there
    np.testing.assert_allclose(values, values[-1] + times / PERIOD, atol=1e-3)
    assert times[0] >= -LONGEST
    assert trends.curve('distance', 10 * PERIOD)[0].size == min(count, 11)


def test_many_channels_are_bounded_too() -> None:
    trends = Trends(AXES)
    trends.add(0.0, replace(READY, io=ShownIo(values={'digital_inputs': (0.0,) * 5000})))
    assert sum(one.key.startswith('digital') for one in trends.signals) == MOST_CHANNELS

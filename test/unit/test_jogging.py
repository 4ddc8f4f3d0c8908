"""Jogging: who may jog, what a command does, and how the stream ends."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.errors import InvalidInputError, PlanningError
from robots_planning.guidance.jogging import NOT_FOLLOWING, Jogging
from robots_planning.guidance.teach_box import JOG_RATE

ROBOT = load_robot_model('bello_bot')
HOME = np.array(ROBOT.home)
COMMAND = np.eye(ROBOT.num_axes)[1] * 0.1


class Bench:
    """A robot that stands, and a controller that follows unless it is held."""

    def __init__(self) -> None:
        self.q, self.busy, self.held, self.time = HOME.copy(), False, False, 0.0
        self.jogging = Jogging(
            ROBOT, standing=lambda: self.q, busy=lambda: self.busy, reference=lambda: self.q
        )

    def run(self, periods: int, command: np.ndarray | None = None) -> int:
        """Step while the stream lasts; the number of references that were made."""
        for made in range(periods):
            if command is not None:
                self.jogging.jog_axes(command, 0.0, self.time)
            step = self.jogging.step(self.time)
            self.time += 1.0 / JOG_RATE
            if step is None:
                self.jogging.end()
                return made
            if not self.held:
                self.q = step.q
        return periods


def test_the_stream_ends_when_nobody_jogs_and_the_robot_stands():
    bench = Bench()
    assert bench.run(50, COMMAND) == 50
    assert bench.jogging.active
    assert 12 < bench.run(500) < 100  # the timeout, and the way to brake
    assert not bench.jogging.active
    assert bench.q[1] > HOME[1]
    np.testing.assert_array_equal(np.delete(bench.q, 1), np.delete(HOME, 1))


def test_a_command_begins_a_stream_unless_there_is_one():
    bench = Bench()
    for _ in range(2):
        assert bench.jogging.jog_axes(COMMAND, 0.0, bench.time)
        assert not bench.jogging.jog_axes(COMMAND, 0.0, bench.time)
        assert not bench.jogging.jog_tool(np.eye(6)[0], 'base', 0.0, bench.time)
        bench.run(500)
        assert not bench.jogging.active


def test_no_velocity_starts_nothing():
    bench = Bench()
    assert not bench.jogging.jog_axes(0.0 * COMMAND, 0.0, 0.0)
    assert not bench.jogging.active


def test_a_robot_with_a_motion_is_not_jogged():
    bench = Bench()
    bench.busy = True
    with pytest.raises(PlanningError, match='a motion runs'):
        bench.jogging.jog_axes(COMMAND, 0.0, 0.0)
    assert not bench.jogging.active


def test_stale_commands_and_bad_values_are_refused():
    bench = Bench()
    with pytest.raises(PlanningError, match=r'is 0\.2 s old, allowed is 0\.1 s'):
        bench.jogging.jog_axes(COMMAND, 0.2, 1.0)
    with pytest.raises(InvalidInputError, match='must be a finite number'):
        bench.jogging.jog_tool([np.nan] * 6, 'base', 0.0, 1.0)
    assert not bench.jogging.active


def test_the_stream_ends_when_the_controller_does_not_follow():
    bench = Bench()
    bench.held = True
    assert 0 < bench.run(500, COMMAND) < 500
    assert bench.jogging.limits == (NOT_FOLLOWING,)
    bench.held = False
    assert bench.run(5, COMMAND) == 5
    assert not bench.jogging.limits


def test_a_tool_is_used_from_the_next_jog_on():
    bench = Bench()
    bench.jogging.use_tool(Pose([0.0, 0.0, 0.3], np.eye(3)))
    before = ROBOT.direct_kinematics(HOME)
    for k in range(60):
        bench.jogging.jog_tool([0.0, 0.0, 0.0, 0.0, 0.2, 0.0], 'tool', 0.0, k / JOG_RATE)
        step = bench.jogging.step(k / JOG_RATE)
        assert step is not None
        bench.q = step.q
    after = ROBOT.direct_kinematics(bench.q)
    tips = [r + T @ np.array([0.0, 0.0, 0.3]) for r, T in (before, after)]
    assert np.linalg.norm(after[0] - before[0]) > 0.01 > np.linalg.norm(tips[1] - tips[0])

"""How much of its limits a robot uses by references, as values and as steps."""

from __future__ import annotations

import numpy as np
import pytest

from robots_controller.recording.reference_use import QUANTITIES, ReferenceUse
from robots_core import BaseRobotModel, load_robot_model
from robots_planning import Trajectory

PERIOD = 0.004
COUNT = 50


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('ur10e')


def accelerated(robot: BaseRobotModel, joint: int, part: float) -> list[np.ndarray]:
    """Position, velocity, acceleration of one axis from rest at a part of its acceleration limit."""
    t = PERIOD * np.arange(COUNT)
    acceleration = part * robot.axes_data.acceleration[joint]
    values = [np.tile(robot.home, (COUNT, 1)), np.zeros((COUNT, 6)), np.zeros((COUNT, 6))]
    for rows, law in zip(
        values, (0.5 * acceleration * t**2, acceleration * t, acceleration + 0 * t), strict=True
    ):
        rows[:, joint] += law
    return values


def use_of(robot: BaseRobotModel, values: list[np.ndarray], time: np.ndarray | None = None) -> ReferenceUse:
    return ReferenceUse(
        robot, Trajectory(PERIOD * np.arange(COUNT) if time is None else time, *values), PERIOD
    )


def test_values_are_compared_with_their_limits(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 2, 0.6)
    uses = use_of(robot, values).worst(0, COUNT - 1)
    assert tuple(uses) == QUANTITIES
    axes = robot.axes_data
    assert uses['acceleration'].joint == axes.names[2]
    assert uses['acceleration'].ratio == pytest.approx(0.6, rel=1e-6)
    assert uses['velocity'].value == pytest.approx(values[1][-1, 2], rel=1e-9)
    assert uses['velocity'].time == pytest.approx(PERIOD * (COUNT - 1))
    tau = robot.rigid_dynamics(values[0][-1], values[1][-1], values[2][-1])[0]
    assert uses['torque'].ratio >= np.abs(tau / axes.effort).max() * (1.0 - 1e-12)
    middle, half = 0.5 * (axes.lower + axes.upper), 0.5 * (axes.upper - axes.lower)
    assert uses['position'].ratio == pytest.approx((np.abs(values[0] - middle) / half).max())


def test_a_part_of_a_motion_is_judged_by_itself_alone(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 1, 0.5)
    use = use_of(robot, values)
    first, last = 10, 30
    # It moves at both ends of the part: that is no acceleration.
    part = use.worst(first, last)
    assert part['acceleration'].ratio == pytest.approx(0.5, rel=1e-6)
    assert part['velocity'].value == pytest.approx(values[1][last, 1], rel=1e-9)
    assert part['velocity'].time == pytest.approx(PERIOD * (last - first))


def test_a_step_that_no_value_tells_of_is_seen(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 0, 0.0)
    values[0][20:, 0] += 0.03
    uses = use_of(robot, values).worst(0, COUNT - 1)
    assert uses['velocity'].ratio == pytest.approx(0.03 / PERIOD / robot.axes_data.velocity[0])
    assert uses['acceleration'].ratio == pytest.approx(0.03 / PERIOD**2 / robot.axes_data.acceleration[0])
    assert uses['velocity'].time == pytest.approx(PERIOD * 20)


def test_no_acceleration_is_made_of_steps_over_a_gap(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 3, 0.9)
    rows = np.r_[0:20, 27:COUNT]
    time = PERIOD * np.arange(COUNT)[rows]
    use = use_of(robot, [value[rows] for value in values], time)
    assert use.worst(0, rows.size - 1)['acceleration'].ratio == pytest.approx(0.9, rel=1e-6)

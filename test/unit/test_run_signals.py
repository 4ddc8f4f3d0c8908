"""How much of its limits a robot uses by references, as values and as steps."""

from __future__ import annotations

import numpy as np
import pytest

from robots_controller.report.recorded_run import RecordedRun
from robots_controller.report.run_signals import QUANTITIES, RunSignals
from robots_core import BaseRobotModel, load_robot_model

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


def use_of(
    robot: BaseRobotModel,
    values: list[np.ndarray],
    time: np.ndarray | None = None,
    late: np.ndarray | None = None,
) -> dict[str, np.ndarray]:
    q, q_dot, q_ddot = values
    run = RecordedRun(
        source='',
        robot=robot,
        time=PERIOD * np.arange(COUNT) if time is None else time,
        period=PERIOD,
        late=np.zeros(len(q)) if late is None else late,
        reference=(q, q_dot, q_ddot),
        feedback=(q, q_dot),
        effort=None,
        motions=(),
        program=(),
        io=(),
        distance=np.zeros((0, 2)),
        duration=1.0,
    )
    return RunSignals.of(run).use


def test_values_are_compared_with_their_limits(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 2, 0.6)
    use = use_of(robot, values)
    assert tuple(use) == QUANTITIES
    axes = robot.axes_data
    assert use['acceleration'].max(axis=0) == pytest.approx([0, 0, 0.6, 0, 0, 0], rel=1e-6)
    assert use['velocity'][:, 2] * axes.velocity[2] == pytest.approx(values[1][:, 2], rel=1e-9)
    tau = robot.rigid_dynamics(values[0][-1], values[1][-1], values[2][-1])[0]
    assert use['torque'][-1] == pytest.approx(np.abs(tau / axes.effort))
    middle, half = 0.5 * (axes.lower + axes.upper), 0.5 * (axes.upper - axes.lower)
    assert use['position'] == pytest.approx(np.abs(values[0] - middle) / half)


def test_a_step_that_no_value_reports_is_found(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 0, 0.0)
    values[0][20:, 0] += 0.03
    use = use_of(robot, values)
    assert use['velocity'].max() == pytest.approx(0.03 / PERIOD / robot.axes_data.velocity[0])
    assert use['acceleration'].max() == pytest.approx(0.03 / PERIOD**2 / robot.axes_data.acceleration[0])
    assert use['velocity'].max(axis=1).argmax() == 20


def test_no_acceleration_is_made_of_steps_over_a_gap(robot: BaseRobotModel) -> None:
    values = accelerated(robot, 3, 0.9)
    rows = np.r_[0:20, 27:COUNT]
    use = use_of(robot, [value[rows] for value in values], PERIOD * np.arange(COUNT)[rows])
    assert use['acceleration'].max() == pytest.approx(0.9, rel=1e-6)


def test_references_of_a_controller_that_was_held_up_follow_each_other_by_a_period(
    robot: BaseRobotModel,
) -> None:
    values = accelerated(robot, 3, 0.9)
    held_up = 7 * PERIOD * (np.arange(COUNT) == 20)
    use = use_of(robot, values, PERIOD * np.arange(COUNT) + np.cumsum(held_up), held_up)
    assert use['acceleration'].max() == pytest.approx(0.9, rel=1e-6)
    assert use['velocity'][:, 3] * robot.axes_data.velocity[3] == pytest.approx(values[1][:, 3], rel=1e-9)

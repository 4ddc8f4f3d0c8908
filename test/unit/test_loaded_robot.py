"""LoadedRobot: what a robot carries counts in its torques, its plans and their verification."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks.multibody.loaded_robot import loaded_robot
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import payload_of
from robots_core.errors import InvalidInputError
from robots_core.robot_model.wrapped_robot import WrappedRobot
from robots_planning import MotionSettings, PathPlanning, verify
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, QueuedCommand
from robots_planning.motion_kinds import LINE

HEAVY = (210.0, 0.05, 0.0, 0.3, 8.0, 0.1, 0.0, 9.0, 0.2, 6.0)
START = np.array([0.0, -0.6, 0.9, 0.1, 0.9, 0.0])  # far out, where A2 has little torque left
FAST: dict[str, Any] = {
    'cartesian_planner': 'dynamic_programming',
    'cartesian_speed': 5.0,
    'cartesian_acceleration': 50.0,
}


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


def test_torques_are_those_of_robot_and_payload(robot: BaseRobotModel) -> None:
    loaded = loaded_robot(robot, HEAVY)
    other = NumericalDynamics(robot, payload=payload_of(HEAVY), rotors=False)
    rng = np.random.default_rng(0)
    for _ in range(10):
        q, q_dot, q_ddot = rng.uniform(-1.0, 1.0, (3, 6))
        tau, M, tau_aux = loaded.rigid_dynamics(q, q_dot, q_ddot)
        np.testing.assert_allclose(tau, M @ q_ddot + tau_aux, rtol=1e-12)
        # Two ways to compute some 10^3 N m.
        np.testing.assert_allclose(loaded.rigid_dynamics_model.torques(q, q_dot, q_ddot), tau, atol=1e-9)
        np.testing.assert_allclose(M, other.mass_matrix(q), atol=1e-9)
        np.testing.assert_allclose(tau_aux, loaded.rigid_dynamics_model.bias_torques(q, q_dot), atol=1e-9)
    added = loaded.rigid_dynamics_model.masses.sum() - robot.rigid_dynamics_model.masses.sum()
    assert added == pytest.approx(HEAVY[0])


def test_without_mass_it_is_the_robot_itself(robot: BaseRobotModel) -> None:
    assert loaded_robot(robot, (0.0, 0.1, 0.0, 0.0)) is robot


def test_plans_with_torque_limits_keep_them_with_the_payload(robot: BaseRobotModel) -> None:
    planning = PathPlanning(robot)
    pose = Pose(*robot.direct_kinematics(START))
    target = Pose(pose.r + np.array([0.0, 0.0, 0.6]), pose.T)
    empty, heavy = (
        planning.plan(LINE, START, target, MotionSettings(payload=payload, **FAST))
        for payload in ((0.0, 0.0, 0.0, 0.0), HEAVY)
    )
    assert heavy.duration > empty.duration
    assert heavy.report.uses['torque'].ratio == pytest.approx(1.0, abs=1e-3)
    loaded = loaded_robot(robot, HEAVY)
    assert verify(heavy.trajectory, loaded).ok
    assert not verify(empty.trajectory, loaded).ok
    assert verify(empty.trajectory, robot).ok


def test_chains_keep_torque_limits_with_the_payload(robot: BaseRobotModel) -> None:
    pose = Pose(*robot.direct_kinematics(START))
    steps = ([0.0, 0.0, 0.6], [-0.4, 0.0, 0.4])
    commands = tuple(
        QueuedCommand(
            str(number),
            LINE,
            Pose(pose.r + np.array(step), pose.T),
            MotionSettings(payload=HEAVY, blend_zone=0.05, **FAST),
            0.0,
        )
        for number, step in enumerate(steps)
    )
    motion = MotionChain(PathPlanning(robot)).plan(CommandChain(commands), START).motion
    assert verify(motion.trajectory, loaded_robot(robot, HEAVY)).ok


@pytest.mark.parametrize('values', [(1.0,), (-1.0, 0.0, 0.0, 0.0), (np.nan, 0.0, 0.0, 0.0), (1.0,) * 5])
def test_numbers_of_no_payload_are_refused(values: tuple[float, ...]) -> None:
    with pytest.raises(InvalidInputError):
        MotionSettings(payload=values)


def test_a_wrapped_robot_has_all_that_its_robot_has() -> None:
    members = {name for name in vars(BaseRobotModel) if not name.startswith('_')}
    assert members - set(vars(WrappedRobot)) == {'num_axes'}  # which is that of the axes' data

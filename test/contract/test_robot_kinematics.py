"""Every robot: pose, frames, Jacobian and its derivative agree with each other and with the description."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose
from robots_core.errors import InvalidInputError, NoAnalyticInverseKinematicsError
from robots_core.orientation import rotation_vector

from .reference import DIFFERENCE_TOLERANCE, DescribedRobot, derivative, twist

# Products of some ten rotations and sums of some ten lengths of metres: a few 1e-15 each. Descriptions
# print angles with twelve digits, so that their rotations are orthonormal to 1e-11 and better.
EXACT = 1e-11
# A product of as many rotations as a robot has axes, per metre of reach.
ROUNDING = 1e-13


def test_pose_is_a_position_and_a_rotation(robot: BaseRobotModel, postures: np.ndarray):
    for q in postures:
        r, T = robot.direct_kinematics(q)
        assert r.shape == (3,)
        assert T.shape == (3, 3)
        np.testing.assert_allclose(T @ T.T, np.eye(3), atol=EXACT)
        assert np.linalg.det(T) > 0.0


def test_pose_is_that_of_direct_kinematics_and_stays_so(robot: BaseRobotModel, postures: np.ndarray):
    poses = [robot.pose(q) for q in postures]
    for q, pose in zip(postures, poses, strict=True):
        expected = Pose(*robot.direct_kinematics(q))
        np.testing.assert_array_equal(pose.r, expected.r)
        np.testing.assert_array_equal(pose.T, expected.T)
        assert not pose.r.flags.writeable
        assert not pose.T.flags.writeable
    with pytest.raises(InvalidInputError):
        robot.pose(np.full(robot.num_axes, np.nan))


def test_poses_at_many_joint_positions_are_those_at_each(robot: BaseRobotModel, postures: np.ndarray):
    for some in (postures, postures[:0], np.asfortranarray(postures)):
        r, T = robot.tool_poses(some)
        assert r.shape == (len(some), 3)
        assert T.shape == (len(some), 3, 3)
        for q, mine in zip(some, zip(r, T, strict=True), strict=True):
            for part, its in zip(mine, robot.direct_kinematics(q), strict=True):
                np.testing.assert_allclose(part, its, rtol=0.0, atol=ROUNDING)
    for wrong in (np.full_like(postures, np.nan), postures[:, 1:]):
        with pytest.raises(InvalidInputError):
            robot.tool_poses(wrong)


def test_pose_and_frames_are_those_of_the_description(robot: BaseRobotModel, postures: np.ndarray):
    described = DescribedRobot(robot)
    for q in postures:
        if described.model.existFrame('tool0'):
            for mine, its in zip(robot.direct_kinematics(q), described.frame('tool0', q), strict=True):
                np.testing.assert_allclose(mine, its, atol=EXACT)
        r, T = robot.kinematic_model.frame_axes(q)
        for index, name in enumerate(robot.axes_data.names):
            its_r, its_T = described.frame(name, q)
            np.testing.assert_allclose(r[index], its_r, atol=EXACT)
            np.testing.assert_allclose(T[index], its_T, atol=EXACT)


def test_tool0_is_fixed_to_the_last_axis(robot: BaseRobotModel, postures: np.ndarray):
    tools = []
    for q in postures:
        r, T = robot.kinematic_model.frame_axes(q)
        assert r.shape == (robot.num_axes, 3)
        assert T.shape == (robot.num_axes, 3, 3)
        tools.append(Pose(r[-1], T[-1]).inverse() @ Pose(*robot.direct_kinematics(q)))
    for tool in tools[1:]:
        np.testing.assert_allclose(tool.r, tools[0].r, atol=EXACT)
        np.testing.assert_allclose(tool.T, tools[0].T, atol=EXACT)


def test_an_axis_moves_what_is_behind_it_and_nothing_else(robot: BaseRobotModel, postures: np.ndarray):
    angle = 0.1
    for q in postures[:5]:
        before_r, before_T = robot.kinematic_model.frame_axes(q)
        for index in range(robot.num_axes):
            moved = q.copy()
            moved[index] += angle
            r, T = robot.kinematic_model.frame_axes(moved)
            np.testing.assert_allclose(r[:index], before_r[:index], atol=EXACT)
            np.testing.assert_allclose(T[:index], before_T[:index], atol=EXACT)
            turned = float(np.linalg.norm(rotation_vector(T[index] @ before_T[index].T)))
            shifted = float(np.linalg.norm(r[index] - before_r[index]))
            expected = (0.0, angle) if robot.axes_data.prismatic[index] else (angle, 0.0)
            np.testing.assert_allclose((turned, shifted), expected, atol=EXACT)


def test_jacobian_is_the_derivative_of_the_pose(robot: BaseRobotModel, postures: np.ndarray):
    for q in postures:
        jacobian = robot.jacobian(q)
        assert jacobian.shape == (6, robot.num_axes)
        for index, unit in enumerate(np.eye(robot.num_axes)):
            expected = twist(lambda h, q=q, unit=unit: robot.direct_kinematics(q + h * unit))
            np.testing.assert_allclose(jacobian[:, index], expected, atol=DIFFERENCE_TOLERANCE)


def test_jacobian_der_is_the_derivative_of_the_jacobian(robot: BaseRobotModel, postures: np.ndarray):
    for q, q_dot in zip(postures, postures[::-1], strict=True):
        expected = derivative(lambda h, q=q, q_dot=q_dot: robot.jacobian(q + h * q_dot))
        np.testing.assert_allclose(robot.jacobian_der(q, q_dot), expected, atol=10.0 * DIFFERENCE_TOLERANCE)


def test_orientation_and_jacobians_are_those_of_each_call(robot: BaseRobotModel, postures: np.ndarray):
    for q, q_dot in zip(postures, postures[::-1], strict=True):
        expected = robot.direct_kinematics(q)[1], robot.jacobian(q), robot.jacobian_der(q, q_dot)
        for mine, its in zip(robot.orientation_and_jacobians(q, q_dot), expected, strict=True):
            np.testing.assert_allclose(mine, its, rtol=0.0, atol=EXACT)


def test_results_belong_to_the_caller(robot: BaseRobotModel, postures: np.ndarray):
    first, second = postures[0], postures[1]

    def everything(q: np.ndarray) -> list[np.ndarray]:
        return [
            *robot.direct_kinematics(q),
            *robot.kinematic_model.frame_axes(q),
            robot.jacobian(q),
            robot.jacobian_der(q, q),
            *robot.orientation_and_jacobians(q, q),
            *robot.rigid_dynamics(q, q, q),
            robot.rigid_dynamics_model.torques(q, q, q),
        ]

    kept = everything(first)
    copies = [array.copy() for array in kept]
    for array in everything(second):
        array[...] = np.nan  # what the caller does with its results must not reach the robot
    for mine, copy, again in zip(kept, copies, everything(first), strict=True):
        np.testing.assert_array_equal(mine, copy)
        np.testing.assert_array_equal(again, copy)


def test_analytic_inverse_kinematics_reaches_its_pose(robot: BaseRobotModel, postures: np.ndarray):
    for q in postures:
        pose = Pose(*robot.direct_kinematics(q))
        try:
            solutions = robot.inverse_kinematics_analytic(pose.r, pose.T)
        except NoAnalyticInverseKinematicsError as error:
            assert robot.name in str(error)  # noqa: PT017  # offering none is the other valid answer
            continue
        assert len(solutions) > 0
        for solution in solutions:
            robot.axes_data.check_position(solution)
            distance, angle = pose.distance_to(Pose(*robot.direct_kinematics(solution)))
            # Ten times better than what the suite promises of a motion, 0.1 mm and 0.01 degrees.
            assert distance < 1e-5
            assert angle < 1e-5


@pytest.mark.parametrize('turns', [1, -1])
def test_a_full_turn_changes_nothing(robot: BaseRobotModel, postures: np.ndarray, turns: int):
    for q in postures[:3]:
        turned = q + 2.0 * np.pi * turns * ~np.array(robot.axes_data.prismatic)
        for mine, its in zip(robot.direct_kinematics(turned), robot.direct_kinematics(q), strict=True):
            np.testing.assert_allclose(mine, its, atol=EXACT)

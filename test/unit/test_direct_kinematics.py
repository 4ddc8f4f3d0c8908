"""DirectKinematics: the tool's pose and Jacobian, against difference quotients."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, available_robot_models, load_robot_model
from robots_core.blocks.direct_kinematics import DirectKinematics
from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_vector

TOOL = Pose.from_angles([0.1, -0.25, 0.4], [0.3, -1.0, 2.0])
STEP = 1e-5
# Central differences: truncation and rounding are both near 1e-11 times metres and squared speeds of a few.
DIFFERENCE = 1e-7


@pytest.fixture(params=available_robot_models())
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


@pytest.fixture
def positions(robot: BaseRobotModel) -> np.ndarray:
    axes = robot.axes_data
    lower, upper = axes.one_turn
    return np.random.default_rng(11).uniform(lower, upper, (10, axes.num_axes))


def test_without_tool_it_is_the_robot(robot: BaseRobotModel, positions: np.ndarray):
    block = DirectKinematics(robot)
    for q in positions:
        pose = block.forward(q)
        r, T = robot.direct_kinematics(q)
        np.testing.assert_allclose(pose.r, r, atol=1e-15)
        np.testing.assert_allclose(pose.T, T, atol=1e-15)
        np.testing.assert_allclose(block.jacobian(q), robot.jacobian(q), atol=1e-15)


def test_tool_is_seen_from_tool0(robot: BaseRobotModel, positions: np.ndarray):
    block = DirectKinematics(robot, tool=TOOL)
    for q in positions:
        tool = Pose(*robot.direct_kinematics(q)).inverse() @ block.forward(q)
        np.testing.assert_allclose(tool.r, TOOL.r, atol=1e-11)  # the description's angles have 12 digits
        np.testing.assert_allclose(tool.T, TOOL.T, atol=1e-11)


def test_jacobian_is_the_derivative_of_the_tool_pose(robot: BaseRobotModel, positions: np.ndarray):
    block = DirectKinematics(robot, tool=TOOL)
    for q in positions:
        jacobian = block.jacobian(q)
        for index, unit in enumerate(np.eye(robot.num_axes)):
            before, after = block.forward(q - STEP * unit), block.forward(q + STEP * unit)
            moved = np.concatenate([after.r - before.r, rotation_vector(after.T @ before.T.T)])
            np.testing.assert_allclose(jacobian[:, index], moved / (2.0 * STEP), atol=DIFFERENCE)


def test_jacobian_der_is_the_derivative_of_the_jacobian(robot: BaseRobotModel, positions: np.ndarray):
    block = DirectKinematics(robot, tool=TOOL)
    for q, q_dot in zip(positions, positions[::-1], strict=True):
        change = block.jacobian(q + STEP * q_dot) - block.jacobian(q - STEP * q_dot)
        np.testing.assert_allclose(block.jacobian_der(q, q_dot), change / (2.0 * STEP), atol=DIFFERENCE)


@pytest.mark.parametrize('tool', [None, TOOL])
def test_results_stay_when_the_block_is_called_again(
    robot: BaseRobotModel, positions: np.ndarray, tool: Pose | None
):
    block = DirectKinematics(robot, tool=tool)

    def everything(q: np.ndarray) -> list[np.ndarray]:
        pose = block.forward(q)
        return [pose.r, pose.T, block.jacobian(q), block.jacobian_der(q, q)]

    kept = everything(positions[0])
    copies = [array.copy() for array in kept]
    everything(positions[1])
    for mine, copy in zip(kept, copies, strict=True):
        np.testing.assert_array_equal(mine, copy)


@pytest.mark.parametrize('bad', [np.zeros(2), np.zeros((7, 1)), None])
def test_bad_positions_are_refused(robot: BaseRobotModel, bad: np.ndarray | None):
    block = DirectKinematics(robot, tool=TOOL)
    q = np.full(robot.num_axes, np.nan) if bad is None else bad
    for call in (block.forward, block.jacobian, lambda q: block.jacobian_der(q, robot.home)):
        with pytest.raises(InvalidInputError):
            call(q)
    with pytest.raises(InvalidInputError):
        block.jacobian_der(robot.home, q)

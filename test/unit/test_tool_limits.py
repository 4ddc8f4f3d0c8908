"""The tool's derivatives along a path are those of the robot's Jacobian."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import available_robot_models, load_robot_model
from robots_core.kernels.serial_chain import SerialChain
from robots_planning.timing.tool_limits import tool_derivatives

ROWS = 5


@pytest.mark.parametrize('name', available_robot_models())
def test_derivatives_of_the_tool_are_those_of_the_jacobian(name: str) -> None:
    robot = load_robot_model(name)
    random = np.random.default_rng(1)
    q, q_s, q_ss = random.uniform(-1.0, 1.0, (3, ROWS, robot.num_axes))
    tools = random.uniform(-0.5, 0.5, (ROWS, 3))
    x_s, x_ss = tool_derivatives(SerialChain.of(robot).arrays, tools, q, q_s, q_ss)
    for row in range(ROWS):
        first = robot.jacobian(q[row]) @ q_s[row]
        second = robot.jacobian(q[row]) @ q_ss[row] + robot.jacobian_der(q[row], q_s[row]) @ q_s[row]
        arm = robot.direct_kinematics(q[row])[1] @ tools[row]
        turning, swing = first[3:], np.cross(first[3:], arm)
        first[:3] += swing
        second[:3] += np.cross(second[3:], arm) + np.cross(turning, swing)
        np.testing.assert_allclose(x_s[row], first, atol=1e-12)
        np.testing.assert_allclose(x_ss[row], second, atol=1e-12)

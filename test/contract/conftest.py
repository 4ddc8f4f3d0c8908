"""The contract suite runs on every robot that is installed, third-party ones too."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import BaseRobotModel, available_robot_models, load_robot_model

POSTURES = 20


@pytest.fixture(params=available_robot_models())
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    """Each installed robot in turn."""
    return load_robot_model(request.param)


@pytest.fixture
def postures(robot: BaseRobotModel) -> np.ndarray:
    """Joint positions all over the robot's range, (k, n), the home posture among them."""
    axes = robot.axes_data
    lower = np.where(axes.continuous, -np.pi, axes.lower)
    upper = np.where(axes.continuous, np.pi, axes.upper)
    random = np.random.default_rng(7).uniform(lower, upper, (POSTURES, axes.num_axes))
    return np.vstack([robot.home, random])

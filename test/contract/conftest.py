"""The contract suite runs on every robot that is installed, third-party ones too.

`pytest test/contract --robot-model NAME` runs it on one robot alone; NAME may be `urdf:/path/robot.urdf` too.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from robots_core import BaseRobotModel, available_robot_models, load_robot_model
from robots_core.errors import RobotsError

POSTURES = 20
_loaded = cache(load_robot_model)


def pytest_configure(config: pytest.Config) -> None:
    """Say once, and not by every test, that a robot cannot be loaded."""
    for name in config.getoption('--robot-model', default=None) or ():
        try:
            _loaded(name)
        except RobotsError as error:
            raise pytest.UsageError(error.message) from None


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run every test that takes a robot on each of the robots."""
    if 'robot_name' in metafunc.fixturenames:
        names = metafunc.config.getoption('--robot-model') or available_robot_models()
        metafunc.parametrize('robot_name', names)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave our own robots' figures out where robots are chosen."""
    if not config.getoption('--robot-model'):
        return
    here = Path(__file__).parent
    others = [
        item
        for item in items
        if here in item.path.parents and 'robot_name' not in getattr(item, 'fixturenames', ())
    ]
    config.hook.pytest_deselected(items=others)
    items[:] = [item for item in items if item not in others]


@pytest.fixture
def robot(robot_name: str) -> BaseRobotModel:
    """Each robot in turn, loaded once."""
    return _loaded(robot_name)


@pytest.fixture
def postures(robot: BaseRobotModel) -> np.ndarray:
    """Joint positions all over the robot's range, (k, n), the home posture among them."""
    axes = robot.axes_data
    lower, upper = axes.one_turn
    random = np.random.default_rng(7).uniform(lower, upper, (POSTURES, axes.num_axes))
    return np.vstack([robot.home, random])

"""Loads the modules of all nodes and the compiled code of one robot, when the fork server imports it."""

import gc
from importlib import import_module
from importlib.metadata import distribution
from typing import Final

from robots_core.robot_choice import available_robot_models, load_robot_model

PACKAGES: Final = ('robots_core', 'robots_planning', 'robots_controller')


def _load() -> None:
    for package in PACKAGES:
        for script in distribution(package).entry_points.select(group='console_scripts'):
            if script.name.endswith('_node'):
                import_module(script.module)
    robot = load_robot_model(available_robot_models()[0])
    robot.direct_kinematics(robot.home)
    # The collector would otherwise write to, and thereby copy, what the forked processes share.
    gc.collect()
    gc.freeze()


_load()

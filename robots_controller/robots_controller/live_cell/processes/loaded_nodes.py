"""Loads the modules of nodes and the compiled code of one robot, when the fork server imports it."""

import gc
import inspect
import sys
from importlib import import_module
from typing import Final

from rosidl_generator_py import import_type_support

from robots_controller.live_cell.node_types import node_scripts
from robots_controller.live_cell.processes.parent_end import on_parent_end
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_planning.guidance.teach_box import JOG_RATE, TeachBox
from robots_planning.pathplanning import PathPlanning

IN_VIEWS: Final = ('visualizer_node',)
"""Loaded where they run: what they alone import takes long, and many cells have no view."""


def _load() -> None:
    for script in node_scripts():
        if script.name not in IN_VIEWS:
            import_module(script.module)
    _load_messages()
    robot = load_robot_model(available_robot_models()[0])
    PathPlanning(robot, collision=CollisionDetection(robot)).warm_up()
    TeachBox(robot, 1.0 / JOG_RATE, robot.home)
    import_module('robots_core.robot_model.analytic.analytic_kernel')  # closed forms, if this robot has none
    # A node's logger looks for its caller, the first time through all modules.
    inspect.getmodule(_load.__code__)
    # The collector would otherwise write to, and thereby copy, what the forked processes share.
    gc.collect()
    gc.freeze()
    on_parent_end(0)  # from now on the server notices it


def _load_messages() -> None:
    """Load the libraries of all message packages that the nodes import."""
    for name in list(sys.modules):
        package, _, rest = name.partition('.')
        if rest in {'msg', 'srv'}:
            import_type_support(package)


_load()

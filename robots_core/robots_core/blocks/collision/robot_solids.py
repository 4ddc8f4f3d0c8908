"""Solids that a robot moves: its own shapes, what is attached to its flange, and its tool centre point."""

from functools import lru_cache
from typing import Final

import numpy as np

from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision.solids import Solid, solids_of
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Mesh
from robots_core.validation import Array

KEPT: Final = 4  # robots; pieces of meshes take a second


@lru_cache(maxsize=KEPT)
def robot_solids(robot: BaseRobotModel) -> tuple[Solid, ...]:
    """The robot's collision shapes as solids."""
    return tuple(
        solid
        for shape in robot.collision_model.shapes
        for solid in solids_of(shape.name, shape.geometry, shape.frame, shape.pose)
    )


def held_solids(robot: BaseRobotModel, scene: Scene) -> tuple[Solid, ...]:
    """The objects of a scene that are attached to the flange, as solids."""
    if not scene.attached:
        return ()
    place = flange(robot)
    return tuple(
        solid
        for item in scene.attached
        for solid in solids_of(item.name, item.geometry, robot.num_axes, place @ item.pose)
    )


def tool_solid(robot: BaseRobotModel, position: Array) -> Solid:
    """The tool centre point as a solid of one point, by its position in tool0, (3,) m."""
    point = Mesh(np.zeros((1, 3)), np.empty((0, 3), dtype=np.int64))
    return Solid('the tool', point, robot.num_axes, flange(robot) @ Pose(position, np.eye(3)))


def flange(robot: BaseRobotModel) -> Pose:
    """Pose of tool0 in the frame of the last axis."""
    r, T = robot.kinematic_model.frame_axes(robot.home)
    return Pose(r[-1], T[-1]).inverse() @ Pose(*robot.direct_kinematics(robot.home))

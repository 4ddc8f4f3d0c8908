"""Solids that a robot moves: its own shapes, what is attached to its flange, and its tool centre point."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision.solids import FLAT, HULL_EXCESS, Solid, solids_of
from robots_core.files.content_cache import Arrays, content_of, kept
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Mesh, Shape
from robots_core.validation import Array

KEPT: Final = 20  # robots
KEPT_FROM: Final = 500  # corners of all meshes; for fewer nothing takes long


def robot_solids(robot: BaseRobotModel) -> tuple[Solid, ...]:
    """The robot's collision shapes as solids; the pieces of large meshes are kept by content."""
    return _solids_of(robot.collision_model.shapes)


@lru_cache(maxsize=KEPT)
def _solids_of(shapes: tuple[Shape, ...]) -> tuple[Solid, ...]:
    meshes = [shape.geometry for shape in shapes if isinstance(shape.geometry, Mesh)]
    arrays = _kept_arrays_of(meshes) if is_large(meshes) else _arrays_of(meshes)
    found: list[Solid] = []
    index = 0
    for shape in shapes:
        if isinstance(shape.geometry, Mesh):
            for number, convex in enumerate(arrays[f'{index}'].tolist()):
                piece = Mesh(arrays[f'{index}.{number}.vertices'], arrays[f'{index}.{number}.faces'])
                found.append(Solid(shape.name, piece, shape.frame, shape.pose, convex))
            index += 1
        else:
            found += solids_of(shape.name, shape.geometry, shape.frame, shape.pose)
    return tuple(found)


def is_large(meshes: Sequence[Mesh]) -> bool:
    """What is computed from the meshes is worth a file."""
    return sum(len(mesh.vertices) for mesh in meshes) >= KEPT_FROM


def _kept_arrays_of(meshes: Sequence[Mesh]) -> Arrays:
    corners_and_faces = (part for mesh in meshes for part in (mesh.vertices, mesh.faces))
    content = content_of((HULL_EXCESS, FLAT, *corners_and_faces))
    return kept('robot_solids', content, lambda: _arrays_of(meshes))


def _arrays_of(meshes: Sequence[Mesh]) -> Arrays:
    """By index of a mesh, which of its pieces are convex; by index and number, vertices and faces of each."""
    arrays: dict[str, NDArray[Any]] = {}
    for index, mesh in enumerate(meshes):
        pieces = solids_of('', mesh, 0, Pose.identity())
        arrays[f'{index}'] = np.array([piece.convex for piece in pieces])
        for number, piece in enumerate(pieces):
            assert isinstance(piece.geometry, Mesh)
            arrays[f'{index}.{number}.vertices'] = piece.geometry.vertices
            arrays[f'{index}.{number}.faces'] = piece.geometry.faces
    return arrays


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
    return Pose(r[-1], T[-1]).inverse() @ robot.pose(robot.home)

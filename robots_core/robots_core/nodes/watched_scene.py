"""The scene of a node: its parameter and file, and the obstacles that messages add."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
from visualization_msgs.msg import Marker, MarkerArray

from robots_core.base_frames import AT_BASE, BASE_FRAMES, TOOL_FRAME, frame_in_base
from robots_core.blocks.collision.scene import OBJECT_COLOUR, AttachedObject, Scene, SceneObject
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box, Cylinder, Geometry, Mesh, Sphere, drawable_colour
from robots_core.robot_model.urdf.urdf_meshes import mesh_path
from robots_core.ros.messages import pose_from_message
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode


class WatchedScene:
    """Follows `collision_objects` from a scene on.

    Args:
        node: Whose scene.
        on_change: Called with the scene, now and at every change; a RobotsError leaves it as it was.
        scene: To begin with; by default that of the parameter, which is declared.

    Raises:
        InvalidInputError: a scene file that is missing or wrong; names its line.
    """

    def __init__(
        self, node: RobotNode, on_change: Callable[[Scene], None], scene: Scene | None = None
    ) -> None:
        self._base_link = node.robot.base_link
        self.scene = scene_by_parameter(node) if scene is None else scene
        on_change(self.scene)
        self._on_change = on_change
        subscribe(node, MarkerArray, 'collision_objects', self._on_objects)

    def _on_objects(self, message: MarkerArray) -> None:
        scene = updated_scene(self.scene, message, self._base_link)
        self._on_change(scene)
        self.scene = scene


def scene_by_parameter(node: RobotNode) -> Scene:
    """Declare the parameter `scene` and read its file; an empty scene without one.

    Raises:
        InvalidInputError: a scene file that is missing or wrong; names its line.
    """
    path = node.parameter('scene', '', 'scene file (YAML); empty for none')
    return read_scene(path) if path else Scene()


def updated_scene(scene: Scene, message: MarkerArray, base_link: Pose = AT_BASE) -> Scene:
    """The scene after a message: its markers added, replaced or deleted, in their order.

    A marker's name is its namespace, or `namespace/id` for an id above 0. Obstacles are in frame `base` (or
    none) or `base_link`, attached objects in `tool0`.

    Raises:
        InvalidInputError: a marker that is no solid; the scene then stays as it was.
    """
    objects = {item.name: item for item in scene.objects}
    attached = {item.name: item for item in scene.attached}
    for marker in message.markers:
        name = marker_name(marker)
        if marker.action == Marker.DELETEALL:
            objects.clear()
            attached.clear()
            continue
        objects.pop(name, None)
        attached.pop(name, None)
        if marker.action == Marker.DELETE:
            continue
        c = marker.color
        frame, pose = marker.header.frame_id, pose_from_message(marker.pose)
        if frame in BASE_FRAMES:
            pose = frame_in_base(frame, base_link) @ pose
        colour = drawable_colour((c.r, c.g, c.b, c.a), OBJECT_COLOUR)
        parts = name, _geometry(marker, name), pose, colour
        if frame == TOOL_FRAME:
            attached[name] = AttachedObject(*parts)
        elif frame in BASE_FRAMES:
            objects[name] = SceneObject(*parts)
        else:
            raise InvalidInputError(
                f'object {name!r} is in frame {frame!r}; known are '
                f'{", ".join(filter(None, BASE_FRAMES))} and {TOOL_FRAME}'
            )
    return replace(scene, objects=tuple(objects.values()), attached=tuple(attached.values()))


def marker_name(marker: Marker) -> str:
    """The name of the object that a marker stands for."""
    return f'{marker.ns or "object"}/{marker.id}' if marker.id or not marker.ns else str(marker.ns)


def _geometry(marker: Marker, name: str) -> Geometry:
    x, y, z = marker.scale.x, marker.scale.y, marker.scale.z
    match marker.type:
        case Marker.CUBE:
            return Box((x, y, z))
        case Marker.SPHERE if x == y == z:
            return Sphere(0.5 * x)
        case Marker.CYLINDER if x == y:
            return Cylinder(0.5 * x, z)
        case Marker.SPHERE | Marker.CYLINDER:
            raise InvalidInputError(f'object {name!r} has an elliptic cross-section ({x:g}, {y:g}, {z:g})')
        case Marker.TRIANGLE_LIST:
            corners = np.array([[p.x * x, p.y * y, p.z * z] for p in marker.points]).reshape(-1, 3)
            if len(corners) == 0 or len(corners) % 3 or not np.isfinite(corners).all():
                raise InvalidInputError(
                    f'object {name!r} has {len(corners)} points; triangles need three finite ones each'
                )
            return Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
        case Marker.MESH_RESOURCE:
            # Imported on demand: most scenes need no library for meshes.
            mesh_file = import_module('robots_core.robot_model.urdf.mesh_file')
            mesh: Mesh = mesh_file.read_mesh(mesh_path(marker.mesh_resource, Path()), (x, y, z))
            return mesh
    raise InvalidInputError(
        f'object {name!r} is a marker of type {marker.type}; solids are CUBE, SPHERE, CYLINDER, '
        f'TRIANGLE_LIST and MESH_RESOURCE'
    )

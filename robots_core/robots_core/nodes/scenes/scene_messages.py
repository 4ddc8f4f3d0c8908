"""visualization_msgs/MarkerArray to obstacles of a scene, and back."""

from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
from builtin_interfaces.msg import Time
from visualization_msgs.msg import Marker, MarkerArray

from robots_core.base_frames import AT_BASE, BASE_FRAME, BASE_FRAMES, TOOL_FRAME, frame_in_base
from robots_core.blocks.collision.scene import OBJECT_COLOUR, AttachedObject, Scene, SceneObject
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere, drawable_colour
from robots_core.robot_model.urdf.urdf_meshes import mesh_path
from robots_core.ros.messages import pose_from_message, pose_message
from robots_core.validation import Array


def updated_scene(scene: Scene, message: MarkerArray, base_link: Pose = AT_BASE) -> Scene:
    """The scene after a message: its markers added, replaced or deleted, in their order.

    A marker's name is its namespace, or `namespace/id` for an id above 0. Obstacles are in frame `base` (or
    none) or `base_link`, attached objects in `tool0`.

    Args:
        scene: Before it.
        message: The message.
        base_link: See `BaseRobotModel.base_link`.

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


def markers(scene: Scene, stamp: Time) -> MarkerArray:
    """The objects of a scene as markers; capsules and meshes as triangles."""
    array = MarkerArray()
    for items, frame in ((scene.objects, BASE_FRAME), (scene.attached, TOOL_FRAME)):
        for item in items:
            marker = Marker(ns=item.name, action=Marker.ADD, pose=pose_message(item.pose))
            marker.header.stamp, marker.header.frame_id = stamp, frame
            c = marker.color
            c.r, c.g, c.b, c.a = item.colour
            _set_geometry(marker, item.geometry)
            array.markers.append(marker)
    return array


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
            # Imported on demand, as below: most scenes need no library for meshes.
            mesh_file = import_module('robots_core.robot_model.urdf.mesh_file')
            mesh: Mesh = mesh_file.read_mesh(mesh_path(marker.mesh_resource, Path()), (x, y, z))
            return mesh
    raise InvalidInputError(
        f'object {name!r} is a marker of type {marker.type}; solids are CUBE, SPHERE, CYLINDER, '
        f'TRIANGLE_LIST and MESH_RESOURCE'
    )


def _set_geometry(marker: Marker, geometry: Geometry) -> None:
    size: Sequence[float] = (1.0, 1.0, 1.0)
    match geometry:
        case Box(edges):
            marker.type, size = Marker.CUBE, edges
        case Sphere(radius):
            marker.type, size = Marker.SPHERE, (2.0 * radius,) * 3
        case Cylinder(radius, length):
            marker.type, size = Marker.CYLINDER, (2.0 * radius, 2.0 * radius, length)
        case Capsule() | Mesh():
            marker.type = Marker.TRIANGLE_LIST
            mesh = import_module('robots_core.robot_model.urdf.triangle_mesh').triangle_mesh(geometry)
            marker.points = [_point(corner) for corner in mesh.triangles.reshape(-1, 3)]
    marker.scale.x, marker.scale.y, marker.scale.z = map(float, size)


def _point(corner: Array) -> object:
    return pose_message(Pose(corner, np.eye(3))).position

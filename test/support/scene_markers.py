"""Scenes as messages of `collision_objects`."""

from collections.abc import Sequence

from builtin_interfaces.msg import Time
from visualization_msgs.msg import Marker, MarkerArray

from robots_core.base_frames import BASE_FRAME, TOOL_FRAME
from robots_core.blocks import Scene
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.robot_model.urdf.triangle_mesh import triangle_mesh
from robots_core.ros.messages import BUILD
from robots_core.validation import Array


def markers(scene: Scene, stamp: Time) -> MarkerArray:
    """The objects of a scene as markers; capsules and meshes as triangles."""
    array = MarkerArray()
    for items, frame in ((scene.objects, BASE_FRAME), (scene.attached, TOOL_FRAME)):
        for item in items:
            pose = BUILD.pose(item.pose.r, item.pose.quaternion())
            marker = Marker(ns=item.name, action=Marker.ADD, pose=pose)
            marker.header.stamp, marker.header.frame_id = stamp, frame
            c = marker.color
            c.r, c.g, c.b, c.a = item.colour
            _set_geometry(marker, item.geometry)
            array.markers.append(marker)
    return array


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
            marker.points = [_point(corner) for corner in triangle_mesh(geometry).triangles.reshape(-1, 3)]
    marker.scale.x, marker.scale.y, marker.scale.z = map(float, size)


def _point(corner: Array) -> object:
    return BUILD.pose(corner, (0.0, 0.0, 0.0, 1.0)).position

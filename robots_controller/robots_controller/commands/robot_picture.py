"""robot_picture: a robot from the side, in characters."""

from collections.abc import Iterator
from itertools import pairwise, product
from typing import Final

import numpy as np

from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.validation import Array

BRAILLE: Final = 0x2800
DOTS: Final = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Of a character of 4 by 2 dots, by row and column."""
SPACING: Final = 0.5
"""Distance of drawn points, in dots."""


def robot_picture(robot: BaseRobotModel, columns: int = 36, rows: int = 18) -> str:
    """The robot at home from its right side, x to the right and z up, in lines of braille characters."""
    lines = np.array(list(_outline(robot)))[:, :, ::2]  # (k, 2, 2): x, z
    low, high = lines.min(axis=(0, 1)), lines.max(axis=(0, 1))
    scale = float(((2 * columns - 1, 4 * rows - 1) / np.maximum(high - low, 1e-3)).min())
    dots = set()
    for begin, end in scale * (lines - low):
        count = max(2, int(np.linalg.norm(end - begin) / SPACING))
        for x, z in np.rint(np.linspace(begin, end, count)).astype(int):
            dots.add((int(x), int(z)))
    height = max(z for _, z in dots) // 4 + 1
    width = max(x for x, _ in dots) // 2 + 1
    cells = np.full((height, width), BRAILLE)
    for x, z in dots:
        row = 4 * height - 1 - z
        cells[row // 4, x // 2] |= DOTS[row % 4, x % 2]
    return '\n'.join(''.join(map(chr, row)).rstrip(chr(BRAILLE)) for row in cells)


def _outline(robot: BaseRobotModel) -> Iterator[Array]:
    """Lines (2, 3), m: the robot from joint to joint to tool0, and the outlines of its bodies."""
    from scipy.spatial import ConvexHull  # noqa: PLC0415  # most commands show no picture

    r, T = robot.kinematic_model.frame_axes(robot.home)
    tool, _ = robot.direct_kinematics(robot.home)
    points = [np.zeros(3), *r, tool]
    yield from (np.array(pair) for pair in pairwise(points))
    for shape in robot.collision_model.shapes:
        vertices = _corners(shape.geometry) @ shape.pose.T.T + shape.pose.r
        if shape.frame:
            vertices = vertices @ T[shape.frame - 1].T + r[shape.frame - 1]
        # Joggled (QJ): a sheet seen from its edge has an outline too.
        yield from vertices[ConvexHull(vertices[:, ::2], qhull_options='QJ').simplices]


def _corners(geometry: Geometry) -> Array:
    """Points (k, 3) whose hull is the geometry, or a box around it."""
    match geometry:
        case Mesh(vertices):
            return vertices
        case Box(size):
            half = 0.5 * np.array(size)
        case Cylinder(radius, length):
            half = np.array([radius, radius, 0.5 * length])
        case Capsule(radius, length):
            half = np.array([radius, radius, 0.5 * length + radius])
        case Sphere(radius):
            half = np.full(3, radius)
    return np.array(list(product((-1.0, 1.0), repeat=3))) * half

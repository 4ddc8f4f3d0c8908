"""Solids that robots look like: hubs, tubes, tapered arms and blocks, as closed triangle meshes.

Every solid is a loft: outlines with equally many points, joined one to the next, closed at both ends.
All lengths are in metres.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from robots_core.robot_model.shapes import Mesh
from robots_core.validation import Array

OUTLINE_POINTS = 40
CHAMFER = 0.012  # m, the broken edge of a cast part

Direction = Literal['x', 'y', 'z']
Circle = tuple[float, float, float]
Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Part:
    """A piece of a robot's body.

    Attributes:
        name: Unique within the robot; also its file name.
        link: The URDF link that it belongs to.
        colour: Red, green, blue, each 0..1.
        collision: Whether it stands for the body in collision checks.
    """

    name: str
    link: str
    colour: Colour
    collision: bool


Drawing = Mapping[Part, Sequence[Mesh]]
"""The parts of a robot, each with its solids in the base frame and with the robot in its drawing posture."""


def body(name: str, link: str, colour: Colour) -> Part:
    """A part that is seen, and stands for the body in collision checks."""
    return Part(name, link, colour, collision=True)


def trim(name: str, link: str, colour: Colour) -> Part:
    """A part that is only seen."""
    return Part(name, link, colour, collision=False)


def enlarged(drawing: Drawing, factor: float) -> Drawing:
    """The drawing with all lengths multiplied by `factor`, seen from the base."""
    return {
        part: [Mesh(factor * mesh.vertices, mesh.faces) for mesh in meshes]
        for part, meshes in drawing.items()
    }


def hub(
    centre: ArrayLike, axis: ArrayLike | Direction, radius: float, length: float, *, chamfer: float = CHAMFER
) -> Mesh:
    """Cylinder with broken edges, its middle at `centre`: the housing of a joint."""
    along = _unit(axis)
    half = 0.5 * length * along
    return tube(np.asarray(centre) - half, np.asarray(centre) + half, radius, radius, chamfer=chamfer)


def tube(
    start: ArrayLike, end: ArrayLike, radius_start: float, radius_end: float, *, chamfer: float = CHAMFER
) -> Mesh:
    """Straight tube from `start` to `end`, (3,) each, whose radius changes evenly."""
    start, end = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length = float(np.linalg.norm(end - start))
    ends = [(0.0, 0.0, radius_start)], [(0.0, 0.0, radius_end)]
    return _with_broken_edges(ends, _frame((end - start) / length), start, (0.0, length), chamfer)


def upright(
    begin: float,
    end: float,
    radius_begin: float,
    radius_end: float,
    *,
    at: tuple[float, float] = (0.0, 0.0),
    chamfer: float = CHAMFER,
) -> Mesh:
    """`tube` parallel to the z axis at (x, y), from one height to another."""
    return tube((*at, begin), (*at, end), radius_begin, radius_end, chamfer=chamfer)


def tapered_arm(
    start: ArrayLike,
    end: ArrayLike,
    radius_start: float,
    radius_end: float,
    *,
    axis: ArrayLike | Direction,
    width: float,
    chamfer: float = CHAMFER,
) -> Mesh:
    """Arm between two parallel joint axes: round at both ends, straight flanks between.

    Args:
        start: Middle of the first end, (3,).
        end: Middle of the other end, (3,).
        radius_start: Radius about `start`.
        radius_end: Radius about `end`.
        axis: Direction of the joint axes.
        width: Extent along `axis`.
        chamfer: Width of the broken edges.
    """
    start, end = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    frame = _frame(_unit(axis))
    x, y = (end - start) @ frame[:, :2]
    circles = [(0.0, 0.0, radius_start), (x, y, radius_end)]
    return _with_broken_edges((circles, circles), frame, start, (-0.5 * width, 0.5 * width), chamfer)


def fork(
    start: ArrayLike,
    end: ArrayLike,
    radius_start: float,
    radius_end: float,
    *,
    axis: ArrayLike | Direction,
    aside: float,
    width: float,
    chamfer: float = CHAMFER,
) -> tuple[Mesh, ...]:
    """Two arms `aside` of the middle, one on each side; the other arguments are those of `tapered_arm`."""
    start, end = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    return tuple(
        tapered_arm(
            start + shift, end + shift, radius_start, radius_end, axis=axis, width=width, chamfer=chamfer
        )
        for shift in (aside * _unit(axis), -aside * _unit(axis))
    )


def plate(
    corners: Sequence[tuple[float, float, float]],
    *,
    axis: ArrayLike | Direction,
    width: float,
    rounding: float,
    chamfer: float = CHAMFER,
) -> Mesh:
    """Convex slab around `corners` in a plane normal to `axis`, as thick as `width`.

    `rounding` is the radius about every corner.
    """
    points = np.asarray(corners, dtype=np.float64)
    frame = _frame(_unit(axis))
    flat = (points - points[0]) @ frame[:, :2]
    circles = [(float(x), float(y), rounding) for x, y in flat]
    return _with_broken_edges((circles, circles), frame, points[0], (-0.5 * width, 0.5 * width), chamfer)


def block(
    centre: ArrayLike,
    size: tuple[float, float, float],
    *,
    axis: Direction = 'z',
    rounding: float = 0.03,
    chamfer: float = CHAMFER,
) -> Mesh:
    """Box with edge lengths `size` along x, y, z; edges along `axis` rounded, the others broken."""
    index = 'xyz'.index(axis)
    others = [i for i in range(3) if i != index]
    corners = []
    for signs in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        corner = np.array(centre, dtype=np.float64)
        for i, sign in zip(others, signs, strict=True):
            corner[i] += sign * (0.5 * size[i] - rounding)
        corners.append(tuple(corner))
    return plate(corners, axis=axis, width=size[index], rounding=rounding, chamfer=chamfer)


def pedestal(
    foot: ArrayLike,
    head: ArrayLike,
    size_foot: tuple[float, float],
    size_head: tuple[float, float],
    *,
    rounding: float = 0.04,
) -> Mesh:
    """Upright body from a rectangle `size_foot` (x, y) about `foot` to one about `head`."""
    foot, head = np.asarray(foot, dtype=np.float64), np.asarray(head, dtype=np.float64)
    rise = head - foot

    def rectangle(size: tuple[float, float]) -> list[Circle]:
        x, y = 0.5 * size[0] - rounding, 0.5 * size[1] - rounding
        return [(-x, -y, rounding), (x, -y, rounding), (x, y, rounding), (-x, y, rounding)]

    frame = np.column_stack([np.eye(3)[:, :2], rise / rise[2]])
    ends = rectangle(size_foot), rectangle(size_head)
    return _with_broken_edges(ends, frame, foot, (0.0, rise[2]), CHAMFER)


def outline(circles: Sequence[Circle]) -> Array:
    """Convex outline around circles (x, y, radius), counter-clockwise, (`OUTLINE_POINTS`, 2).

    Point i is the farthest point of all circles in direction i; outlines of any circles thus have points
    that correspond and can be lofted.
    """
    # Half a step off the axes, where two circles of a rectangle would be equally far.
    angles = (np.arange(OUTLINE_POINTS) + 0.5) * 2.0 * np.pi / OUTLINE_POINTS
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    data = np.asarray(circles, dtype=np.float64)
    farthest = np.argmax(normals @ data[:, :2].T + data[:, 2], axis=1)
    return np.asarray(data[farthest, :2] + data[farthest, 2:] * normals)


def loft(outlines: Sequence[Array]) -> Mesh:
    """Closed surface through outlines (k, 3), the first and the last one filled."""
    count, k = len(outlines), len(outlines[0])
    index = np.arange(count * k).reshape(count, k)
    right = np.roll(index, -1, axis=1)
    a, b, c, d = (corner.ravel() for corner in (index[:-1], right[:-1], right[1:], index[1:]))
    fan = np.stack([np.zeros(k - 2, dtype=np.int64), np.arange(1, k - 1), np.arange(2, k)], axis=1)
    faces = np.concatenate(
        [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1), fan[:, ::-1], fan + index[-1, 0]]
    )
    return Mesh(np.concatenate(outlines), faces)


def stl(meshes: Sequence[Mesh]) -> bytes:
    """The solids as one binary STL file."""
    solids = [trimesh.Trimesh(mesh.vertices, mesh.faces, process=False) for mesh in meshes]
    return bytes(trimesh.exchange.stl.export_stl(trimesh.util.concatenate(solids)))


def _with_broken_edges(
    ends: tuple[Sequence[Circle], Sequence[Circle]],
    frame: Array,
    origin: Array,
    heights: tuple[float, float],
    chamfer: float,
) -> Mesh:
    """The solid between two outlines, each at its height above the x-y plane of a frame at `origin`."""
    (first, last), (low, high) = ends, heights
    sections = (
        (first, chamfer, low),
        (first, 0.0, low + chamfer),
        (last, 0.0, high - chamfer),
        (last, chamfer, high),
    )
    return loft(
        [
            origin
            + outline([(x, y, radius - inset) for x, y, radius in circles]) @ frame[:, :2].T
            + height * frame[:, 2]
            for circles, inset, height in sections
        ]
    )


def _unit(axis: ArrayLike | Direction) -> Array:
    if isinstance(axis, str):
        return np.asarray(np.eye(3)['xyz'.index(axis)])
    vector = np.asarray(axis, dtype=np.float64)
    return np.asarray(vector / np.linalg.norm(vector))


def _frame(z: Array) -> Array:
    """A right-handed frame (3, 3) whose third column is `z`."""
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)

"""Frames from three points: the orientation of a tool, and bases."""

from __future__ import annotations

from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError, MeasurementError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector

Axis = Literal['x', 'y', 'z', '-x', '-y', '-z']
AXES: Final[tuple[Axis, ...]] = get_args(Axis)
SHORTEST: Final = 0.02
"""m, distance of a point from the origin, and of the last one from the axis: 1 mm of it turns the frame by
0.05 rad."""


def measure_base(origin: ArrayLike, on_x: ArrayLike, in_xy: ArrayLike) -> Pose:
    """A base from three points that the tool has touched (3-point method).

    Args:
        origin: Its origin, (3,), m.
        on_x: A point on its positive x axis, (3,), m.
        in_xy: A point of its xy plane with a positive y, (3,), m.

    Returns:
        The base, seen from the frame of the points.

    Raises:
        MeasurementError: a point closer than `SHORTEST` to the origin or the x axis; names the point.
    """
    r = finite_vector(origin, 3, 'origin')
    along, across = finite_vector(on_x, 3, 'on_x') - r, finite_vector(in_xy, 3, 'in_xy') - r
    return Pose(r, _orientation(along, across, 'x'))


def measure_tool_orientation(
    center: ArrayLike,
    touched: ArrayLike,
    on_axis: Pose,
    in_plane: Pose,
    *,
    axis: Axis = '-z',
) -> Pose:
    """A tool with its orientation, from two poses more than its centre point (2-point method).

    In both poses, the fixed point lies where the tool's axes are to be.

    Args:
        center: Tool centre point in tool0, (3,), m.
        touched: The fixed point in the base frame, (3,), m (`ToolCenter.touched`).
        on_axis: tool0 in the base frame, with the fixed point on half `axis` of the tool.
        in_plane: The same with the fixed point in the plane of `axis` and of the axis after it (x y z x),
            where that is positive.
        axis: Half axis: '-z' lies on the tool's shaft, where z is its working direction.

    Returns:
        The tool, seen from tool0.

    Raises:
        InvalidInputError: another axis.
        MeasurementError: the fixed point is closer than `SHORTEST` to the tool centre point or the axis.
    """
    if axis not in AXES:
        raise InvalidInputError(f'axis = {axis!r} is unknown; valid are {", ".join(AXES)}')
    r, fixed = finite_vector(center, 3, 'center'), finite_vector(touched, 3, 'touched')
    along, across = (pose.T.T @ (fixed - pose.r) - r for pose in (on_axis, in_plane))
    return Pose(r, _orientation(along, across, axis))


def _orientation(along: Array, across: Array, axis: Axis) -> Array:
    """Axes of a frame, as columns, (3, 3), from one vector on an axis and another in a plane."""
    first = 'xyz'.index(axis[-1])
    second = (first + 1) % 3
    length = float(np.linalg.norm(along))
    if length < SHORTEST:
        raise MeasurementError(
            f'the point on the {axis} axis is {1e3 * length:.1f} mm from the origin; valid is at least '
            f'{1e3 * SHORTEST:g} mm',
            key='near_origin',
            index=0,
            axis=axis,
            distance=length,
            bound=SHORTEST,
        )
    unit = along / length
    rest = across - (across @ unit) * unit
    distance = float(np.linalg.norm(rest))
    if distance < SHORTEST:
        raise MeasurementError(
            f'the point in the plane is {1e3 * distance:.1f} mm from the {axis} axis; valid is at least '
            f'{1e3 * SHORTEST:g} mm',
            key='near_axis',
            index=1,
            axis=axis,
            distance=distance,
            bound=SHORTEST,
        )
    T = np.empty((3, 3))
    T[:, first] = -unit if axis.startswith('-') else unit
    T[:, second] = rest / distance
    T[:, (first + 2) % 3] = np.cross(T[:, first], T[:, second])
    return T

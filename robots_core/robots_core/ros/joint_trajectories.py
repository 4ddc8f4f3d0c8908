"""Points of trajectory_msgs/JointTrajectory as arrays, joints matched by name."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from trajectory_msgs.msg import JointTrajectory

from robots_core.errors import InvalidInputError
from robots_core.ros.messages import joint_indices, seconds
from robots_core.validation import Array, finite_vector

FIELDS: Final = ('positions', 'velocities', 'accelerations')


def single_point(message: JointTrajectory, names: Sequence[str], what: str) -> Array:
    """Position, velocity and acceleration of a streamed reference, (3, n); those that are missing are 0.

    Args:
        message: With one point.
        names: The wanted joints, n of them.
        what: Topic, for errors.

    Raises:
        InvalidInputError: not one point, missing joints, no positions, or values that are not finite.
    """
    if len(message.points) != 1:
        raise InvalidInputError(f'{what} has {len(message.points)} points, a streamed reference is one point')
    indices, count = joint_indices(message.joint_names, names, what), len(message.joint_names)
    rows = np.zeros((len(FIELDS), len(names)))
    for row, field in zip(rows, FIELDS, strict=True):
        values = getattr(message.points[0], field)
        if len(values) or field == 'positions':
            row[:] = finite_vector(_checked(values, count, f'{what} has', field), count, field)[indices]
    return rows


def point_times(message: JointTrajectory) -> Array:
    """Times of the points, (m,), s."""
    return np.array([seconds(point.time_from_start) for point in message.points])


def field_rows(message: JointTrajectory, names: Sequence[str], what: str, field: str) -> Array:
    """One of `FIELDS` of all points, (m, n).

    Args:
        message: With m points.
        names: The wanted joints, n of them.
        what: Topic, for errors.
        field: Which.

    Raises:
        InvalidInputError: missing joints, or a point without it.
    """
    indices, count = joint_indices(message.joint_names, names, what), len(message.joint_names)
    rows = [
        _checked(getattr(point, field), count, f'{what} point {k} has', field)
        for k, point in enumerate(message.points, 1)
    ]
    return np.array(rows, dtype=np.float64).reshape(len(rows), count)[:, indices]


def _checked(values: Any, count: int, what: str, field: str) -> Any:
    if len(values) != count:
        raise InvalidInputError(f'{what} {len(values)} {field} for {count} joints')
    return values

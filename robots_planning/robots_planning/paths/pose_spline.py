"""PoseSpline: a smooth curve of the tool through poses."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.paths.cartesian_path import (
    COINCIDENT_ANGLE,
    COINCIDENT_DISTANCE,
    CartesianPath,
    no_pieces,
    position_text,
)

# A rotation counts as its arc at this radius, m, when chords are measured.
TURNING_RADIUS = 0.3


class PoseSpline(CartesianPath):
    """A C2 curve that passes every pose, position and orientation, exactly.

    Position is the cubic spline over the chord lengths between the poses (de Boor 2001), so that s is about
    proportional to the arc length. Orientation is the cubic spline of rotation vectors from pose to pose with
    continuous angular velocity and acceleration (McClain and Tapley 1974, as in SciPy's `RotationSpline`).

    Args:
        poses: At least two; the first is at s = 0, the last at s = 1. From each to the next the tool turns by
            less than half a turn.

    Raises:
        InvalidInputError: fewer than two poses, or two in succession that coincide; names them.
    """

    kind = 'spline'

    def __init__(self, poses: Sequence[Pose]) -> None:
        if len(poses) < 2:
            raise InvalidInputError(f'a spline needs at least 2 poses, got {len(poses)}')
        r = np.array([pose.r for pose in poses])
        T = np.array([pose.T for pose in poses])
        steps = chords(poses)
        self.parameters = read_only(np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum())
        """s at each pose."""
        count = len(poses) - 1
        breaks, position, arc, rate, turn, orientation = no_pieces(count)
        breaks[:] = self.parameters
        breaks[-1] = 1.0
        curve = CubicSpline(breaks, r)
        # SciPy's highest power comes first.
        position[:, :4] = np.moveaxis(curve.c[::-1], 0, 1)
        turning = RotationSpline(breaks, Rotation.from_matrix(T))
        if count == 1:
            turn[0, 1] = (Rotation.from_matrix(T[1] @ T[0].T)).as_rotvec()
        else:
            # SciPy's rotation vectors are in the frame of each pose, those of a path in the base frame.
            body = np.moveaxis(turning.interpolator.c[::-1], 0, 1)
            turn[:] = np.einsum('mij,mkj->mki', T[:-1], body)
        orientation[:] = T[:-1]
        super().__init__((breaks, position, arc, rate, turn, orientation))


def chords(poses: Sequence[Pose]) -> Array:
    """Distance from each pose to the next, (m - 1,), m, rotations included.

    Raises:
        InvalidInputError: two poses in succession coincide.
    """
    steps = []
    for index, (first, second) in enumerate(pairwise(poses)):
        distance, angle = first.distance_to(second)
        if distance < COINCIDENT_DISTANCE and angle < COINCIDENT_ANGLE:
            raise InvalidInputError(
                f'poses {index} and {index + 1} of the spline coincide at {position_text(first)}: they are '
                f'{distance:.3g} m and {angle:.3g} rad apart; leave one of them out',
                index=index,
            )
        steps.append(np.hypot(distance, TURNING_RADIUS * angle))
    return np.array(steps)

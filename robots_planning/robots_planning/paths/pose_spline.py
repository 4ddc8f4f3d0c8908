"""PoseSpline: a smooth curve of the tool through poses."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_vectors
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.paths.cartesian_path import (
    COINCIDENT_ANGLE,
    COINCIDENT_DISTANCE,
    CartesianPath,
    empty_pieces,
    position_text,
)
from robots_planning.paths.spline_pieces import position_pieces, turning_pieces

# A rotation counts as its arc at this radius, m, when chords are measured.
TURNING_RADIUS = 0.3


class PoseSpline(CartesianPath):
    """A C2 curve that passes every pose, position and orientation, exactly.

    Position is the cubic spline over the chord lengths between the poses (de Boor 2001), so that s is about
    proportional to the arc length. Orientation is given by cubic rotation vectors from pose to pose, with
    continuous angular velocity and acceleration (McClain and Tapley 1974).

    Args:
        poses: At least two; the first is at s = 0, the last at s = 1. From each to the next the tool turns by
            less than half a turn.

    Raises:
        InvalidInputError: fewer than two poses, two in succession that coincide, or turns that do not become
            smooth, see `turning_pieces`; names the poses.
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
        breaks, position, arc, rate, turn, orientation = empty_pieces(len(poses) - 1)
        breaks[:] = self.parameters
        breaks[-1] = 1.0
        h = np.diff(breaks)
        position[:, :4] = position_pieces(h, r)
        turn[:] = turning_pieces(h, rotation_vectors(T[1:] @ T[:-1].transpose(0, 2, 1)))
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

"""CircularArc: an arc or a full circle of the tool."""

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_vector
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.paths.cartesian_path import (
    CartesianPath,
    check_apart,
    empty_pieces,
    position_text,
)

# Smallest sine of the angle between the chords from the start to the other two points.
SMALLEST_SINE = 1e-6


class CircularArc(CartesianPath):
    """The position moves on the circle through three points at a constant rate.

    The orientation turns at a constant rate about one fixed axis, by at most half a turn.

    Args:
        start: Pose at s = 0.
        via: A point on the arc between start and end; its orientation is not used.
        end: Pose at s = 1. For a full circle its position is the start's.
        second_via: For a full circle a second point, passed after `via`; otherwise None.

    Raises:
        InvalidInputError: points that coincide or lie on a line, a second via point without a full circle, or
            a full circle without one; names the points.
    """

    kind = 'arc'

    def __init__(self, start: Pose, via: Pose, end: Pose, *, second_via: Pose | None = None) -> None:
        third, names = _third_point(start, end, second_via)
        self.center, self.normal, self.radius = circle_through(start, via, third, names)
        out = start.r - self.center
        side = np.cross(self.normal, out)
        if second_via is None:
            to_end = end.r - self.center
            self.arc_angle = float(np.arctan2(to_end @ side, to_end @ out) % (2.0 * np.pi))
        else:
            self.arc_angle = 2.0 * np.pi
        rotation = rotation_vector(end.T @ start.T.T)
        pieces = empty_pieces(1)
        _, position, arc, rate, turn, T = pieces
        position[0, 0] = self.center
        arc[0, 0], arc[0, 1], rate[0] = out, side, self.arc_angle
        turn[0, 1], T[0] = rotation, start.T
        super().__init__(pieces, length=self.radius * self.arc_angle, angle=float(np.linalg.norm(rotation)))


def circle_through(
    start: Pose, via: Pose, third: Pose, names: tuple[str, str, str]
) -> tuple[Array, Array, float]:
    """Centre (3,), unit normal (3,) and radius (m) of the circle that passes three points in this order.

    The motion from start over via to third turns in the positive sense about the normal.

    Raises:
        InvalidInputError: two of them coincide, or all lie on a line; names them.
    """
    check_apart(start, via, (names[0], names[1]), kind='arc')
    check_apart(via, third, (names[1], names[2]), kind='arc')
    check_apart(start, third, (names[0], names[2]), kind='arc')
    a, b = via.r - start.r, third.r - start.r
    cross = np.cross(a, b)
    area = float(np.linalg.norm(cross))
    sine = area / float(np.linalg.norm(a) * np.linalg.norm(b))
    if sine < SMALLEST_SINE:
        raise InvalidInputError(
            f'{names[0]} {position_text(start)}, {names[1]} {position_text(via)} and {names[2]} '
            f'{position_text(third)} lie on a line (sine of the angle between them {sine:.3g}, needed is '
            f'{SMALLEST_SINE:g}): they determine no circle; move {names[1]} aside, or use a straight line',
            sine=sine,
        )
    to_center = ((a @ a) * np.cross(b, cross) + (b @ b) * np.cross(cross, a)) / (2.0 * area**2)
    return read_only(start.r + to_center), read_only(cross / area), float(np.linalg.norm(to_center))


def _third_point(start: Pose, end: Pose, second_via: Pose | None) -> tuple[Pose, tuple[str, str, str]]:
    """The third point of the circle besides start and via, and the names of the three for messages."""
    if second_via is None:
        check_apart(start, end, ('start', 'end'), kind='arc (a full circle needs a second via point)')
        return end, ('start', 'via', 'end')
    closing = float(np.linalg.norm(end.r - start.r))
    # Positions that agree to a tenth of a millimetre are taken for the same point.
    if closing > 1e-4:
        raise InvalidInputError(
            f'two via points make a full circle, which ends where it starts, at {position_text(start)}; '
            f'the end {position_text(end)} is {closing:.4g} m off; leave one via point out for an arc',
            distance=closing,
        )
    return second_via, ('start', 'via', 'second via')

"""CartesianLine: a straight line of the tool with rotation about one axis."""

import numpy as np

from robots_core.orientation import rotation_vector
from robots_core.pose import Pose
from robots_core.validation import Array, read_only
from robots_planning.paths.cartesian_path import CartesianPath, empty_pieces


class CartesianLine(CartesianPath):
    """The position moves straight, the orientation turns about one fixed axis, both at constant rates over s.

    Args:
        start: Pose at s = 0.
        end: Pose at s = 1; the rotation is the one by at most half a turn.
    """

    kind = 'line'

    def __init__(self, start: Pose, end: Pose) -> None:
        self.translation = read_only(end.r - start.r)
        """m, (3,)."""
        self.rotation = read_only(rotation_vector(end.T @ start.T.T))
        """Axis times angle, rad, (3,); the angle is in [0, pi]."""
        pieces = empty_pieces(1)
        _, position, _, _, turn, T = pieces
        position[0, 0], position[0, 1] = start.r, self.translation
        turn[0, 1], T[0] = self.rotation, start.T
        super().__init__(
            pieces,
            length=float(np.linalg.norm(self.translation)),
            angle=float(np.linalg.norm(self.rotation)),
        )

    def travel(self, s: Array) -> tuple[Array, Array, Array]:
        """See `CartesianPath.travel`; both rates are constant."""
        none = np.zeros((len(s), 2))
        return np.full((len(s), 2), (self.length, self.angle)), none, none

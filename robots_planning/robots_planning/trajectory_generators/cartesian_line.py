"""CartesianLine: a straight line of the tool with rotation about one axis."""

from __future__ import annotations

import numpy as np

from robots_core.pose import Pose, rotation_vector
from robots_core.validation import Array, read_only


class CartesianLine:
    """Poses x(s), s in [0, 1]: the position moves straight, the orientation turns about one fixed axis.

    Args:
        start: Pose at s = 0.
        end: Pose at s = 1; of the two ways to turn, the shorter one is taken.
    """

    def __init__(self, start: Pose, end: Pose) -> None:
        self.start = start
        self.end = end
        self.translation = read_only(end.r - start.r)
        self.rotation = read_only(rotation_vector(end.T @ start.T.T))
        self.length = float(np.linalg.norm(self.translation))
        """m."""
        self.angle = float(np.linalg.norm(self.rotation))
        """rad, in [0, pi]."""
        self.derivative = read_only(np.concatenate([self.translation, self.rotation]))
        """x'(s), (6,): linear (m), then angular (rad), base frame; the same for every s."""
        x, y, z = self.rotation / self.angle if self.angle > 0.0 else np.zeros(3)
        self._cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])

    def frame(self, s: float) -> tuple[Array, Array]:
        """Position (3,) and orientation (3, 3) at `s`, by Rodrigues' formula."""
        angle = s * self.angle
        K = self._cross
        turn = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
        return self.start.r + s * self.translation, turn @ self.start.T

    def pose(self, s: float) -> Pose:
        """Pose at `s`."""
        return Pose(*self.frame(s))

"""Numbers of measured frames, as the page shows them: millimetres and degrees."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from robots_core.pose import Pose


def millimetres(r: ArrayLike) -> dict[str, str]:
    """Three lengths in metres, by x, y, z."""
    return {name: f'{1e3 * value + 0.0:.2f}' for name, value in zip('xyz', np.asarray(r), strict=True)}


def degrees(pose: Pose, convention: str) -> dict[str, str]:
    """Orientation angles of a pose, by a, b, c, and their convention."""
    angles = zip('abc', pose.angles(convention).tolist(), strict=True)
    return {'convention': convention, **{name: f'{math.degrees(angle) + 0.0:.2f}' for name, angle in angles}}

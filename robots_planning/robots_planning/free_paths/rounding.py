"""Rounding: a smooth path along certified lines, whose corners are certified too."""

from typing import Final

import numpy as np

from robots_core.blocks.collision.along_paths.path_certificate import FREE
from robots_core.errors import PlanningError
from robots_core.validation import Array
from robots_planning.free_paths.free_path_search import FreePath
from robots_planning.free_paths.search_kernel import LARGEST_CUT
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.quintic import quintic_coefficients

SHORTEST: Final = 1e-9  # rad (m) of the axis that moves most; shorter lines are rounding
NARROWER: Final = 0.7
TRIES: Final = 30  # the last corner is a 30 000th of its line


def rounded(path: FreePath) -> JointPath:
    """The path, each corner replaced by the largest free quintic.

    Position and two derivatives are continuous; s is proportional to the length in joint space of the path.

    Raises:
        PlanningError: a corner cannot be rounded, because its posture only just keeps its distances.
    """
    moving = np.abs(np.diff(path.postures, axis=0)).max(axis=1) > SHORTEST
    moving[0] = True
    # The last posture takes the place of one that it is equal to.
    q = np.concatenate([path.postures[:-1][moving], path.postures[-1:]])
    steps = np.diff(q, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    directions = steps / lengths[:, None]
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    places, rows, slopes = [0.0], [q[0]], [directions[0]]
    for k in range(1, len(q) - 1):
        cut = _cut(path, q[k], directions[k - 1 : k + 1], LARGEST_CUT * min(lengths[k - 1], lengths[k]))
        places += [along[k] - cut, along[k] + cut]
        rows += [q[k] - cut * directions[k - 1], q[k] + cut * directions[k]]
        slopes += [directions[k - 1], directions[k]]
    s = np.array([*places, along[-1]]) / along[-1]
    s[-1] = 1.0
    q_s = np.array([*slopes, directions[-1]]) * along[-1]
    return JointPath(s, np.array([*rows, q[-1]]), q_s, np.zeros_like(q_s), s[1:-1])


def _cut(path: FreePath, p: Array, directions: Array, cut: float) -> float:
    """Length of both lines at posture p, (n,), with their directions (2, n), that a free corner replaces."""
    before, after = directions
    coefficients = np.empty((1, 6, p.size))
    for _ in range(TRIES):
        ends = np.array([p - cut * before, p + cut * after])
        x = np.array([0.0, 2.0 * cut])
        quintic_coefficients(x, ends, np.array([before, after]), np.zeros_like(ends), coefficients)
        over_unit = coefficients[0] * (2.0 * cut) ** np.arange(6)[:, None]
        if path.certificate.piece(over_unit) == FREE:
            return cut
        cut *= NARROWER
    raise PlanningError('the path around obstacles has a corner that cannot be rounded freely')

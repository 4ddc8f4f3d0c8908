"""Deviation of sampled tool poses from a straight line or from any path."""

import numpy as np

from robots_core.orientation import quaternions_of, rotation_vector, rotation_vectors
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.paths.cartesian_path import CartesianPath

# Points of the path among which the nearest is searched, and subdivisions between two of them. On a path of
# 10 m with bends of 0.05 m, the chords between subdivisions are at most 0.6 um off.
PATH_POINTS = 2001
FINER = 10
BRANCHES = 3  # candidates per pose, for paths that cross themselves
ON_PATH = 1e-6  # m; at this distance no further candidate is checked
TURNING_RADIUS = 0.1  # m; a rotation counts as its arc at this radius when poses are compared


def identity_orientations(count: int) -> Array:
    """Orientations of the base frame, (count, 3, 3)."""
    return np.tile(np.eye(3), (count, 1, 1))


def line_deviation(r: Array, T: Array, start: Pose, end: Pose) -> tuple[float, float]:
    """Largest distance (m) and angle (rad) from the straight line between two poses, its ends included.

    Args:
        r: Positions of the tool, (m, 3), m, from the first to the last.
        T: Its orientations, (m, 3, 3).
        start: First pose of the line.
        end: Last pose; the orientation turns about one axis from the first to the last.
    """
    along = end.r - start.r
    squared = float(along @ along)
    part = np.clip((r - start.r) @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(r))
    distance = np.linalg.norm(r - start.r - part[:, None] * along, axis=1)

    turn = rotation_vector(end.T @ start.T.T)
    angle = float(np.linalg.norm(turn))
    k = turn / angle if angle > 0.0 else np.zeros(3)
    quaternion = quaternions_of(T @ start.T.T)
    across = quaternion[:, :3] - (quaternion[:, :3] @ k)[:, None] * k
    away = 2.0 * np.arcsin(np.minimum(np.linalg.norm(across, axis=1), 1.0))
    return _with_ends(r, T, (start, end), distance, away)


def path_deviation(r: Array, T: Array, path: CartesianPath, *, oriented: bool = True) -> tuple[float, float]:
    """Largest distance (m) and angle (rad) from a path, its ends included; r and T as in `line_deviation`.

    Unless `oriented`, the orientations of the path do not count: they are those of the base frame.
    """
    coarse = np.linspace(0.0, 1.0, PATH_POINTS)
    path_r, path_T = _sampled(path, coarse, oriented=oriented)
    features, targets = _features(path_r, path_T), _features(r, T)
    squares = (features**2).sum(axis=1) - 2.0 * targets @ features.T
    best, turned = np.full(len(r), np.inf), np.full(len(r), np.inf)
    for _ in range(BRANCHES):
        rows = np.flatnonzero(best + TURNING_RADIUS * turned > ON_PATH)
        if not rows.size:
            break
        nearest = squares[rows].argmin(axis=1)
        distance, away = _around(path, coarse[nearest], r[rows], T[rows], oriented=oriented)
        closer = distance + TURNING_RADIUS * away < best[rows] + TURNING_RADIUS * turned[rows]
        best[rows[closer]], turned[rows[closer]] = distance[closer], away[closer]
        for step in (-1, 0, 1):
            squares[rows, np.clip(nearest + step, 0, PATH_POINTS - 1)] = np.inf
    ends = Pose(path_r[0], path_T[0]), Pose(path_r[-1], path_T[-1])
    return _with_ends(r, T, ends, best, turned)


def _with_ends(
    r: Array, T: Array, ends: tuple[Pose, Pose], distance: Array, away: Array
) -> tuple[float, float]:
    off = [Pose(r[row], T[row]).distance_to(pose) for row, pose in zip((0, -1), ends, strict=True)]
    return (
        max(float(distance.max()), *(end[0] for end in off)),
        max(float(away.max()), *(end[1] for end in off)),
    )


def _sampled(path: CartesianPath, s: Array, *, oriented: bool) -> tuple[Array, Array]:
    poses = path.sample(s)
    return poses.r, poses.T if oriented else identity_orientations(len(s))


def _around(path: CartesianPath, near: Array, r: Array, T: Array, *, oriented: bool) -> tuple[Array, Array]:
    """Distances (m,) and angles (m,) from the path around s = `near` (m,), by chords between finer points."""
    step = 1.0 / (PATH_POINTS - 1) / FINER
    count = 2 * FINER + 1
    middle = np.clip(near, FINER * step, 1.0 - FINER * step)
    s = (middle[:, None] + step * np.arange(-FINER, FINER + 1)).ravel()
    fine_r, fine_T = _sampled(path, s, oriented=oriented)
    points, orientations = fine_r.reshape(-1, count, 3), fine_T.reshape(-1, count, 3, 3)
    features, targets = _features(fine_r, fine_T).reshape(-1, count, 12), _features(r, T)
    rows = np.arange(len(r))
    first = np.clip(((features - targets[:, None]) ** 2).sum(axis=2).argmin(axis=1), 1, count - 2)
    best, turned = np.full(len(r), np.inf), np.full(len(r), np.inf)
    for begin in (first - 1, first):
        chord = features[rows, begin + 1] - features[rows, begin]
        length = np.maximum((chord**2).sum(axis=1), 1e-300)
        part = np.clip(((targets - features[rows, begin]) * chord).sum(axis=1) / length, 0.0, 1.0)[:, None]
        start, chord_r = points[rows, begin], points[rows, begin + 1] - points[rows, begin]
        distance = np.linalg.norm(r - start - part * chord_r, axis=1)
        back = orientations[rows, begin].transpose(0, 2, 1)
        turn = rotation_vectors(orientations[rows, begin + 1] @ back)
        away = np.linalg.norm(rotation_vectors(T @ back) - part * turn, axis=1)
        closer = distance + TURNING_RADIUS * away < best + TURNING_RADIUS * turned
        best, turned = np.where(closer, distance, best), np.where(closer, away, turned)
    return best, turned


def _features(r: Array, T: Array) -> Array:
    """Vectors whose distance ranks poses, (m, 12), m: position, and orientation scaled by `TURNING_RADIUS`.

    The orientation separates the branches of a path that crosses itself, and the poses of a pure rotation.
    """
    return np.concatenate([r, TURNING_RADIUS * T.reshape(-1, 9)], axis=1)

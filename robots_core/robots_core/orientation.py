"""Orientations: matrices from and to orientation angles, quaternions and rotation vectors."""

from collections.abc import Mapping
from functools import cache
from math import atan2, cos, hypot, sin
from types import MappingProxyType
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robots_core.validation import Array, finite_vector, one_of, rotation_matrix

ORIENTATION_CONVENTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        'zyx': 'KUKA A-B-C: about z, then the new y, then the new x',
        'xyz': 'Staubli and Modelica Cardan: about x, the new y, the new z',
        'zyz': 'Euler: about z, the new y, the new z',
        'XYZ': 'Mitsubishi: about the fixed x, y and z',
        'rotation_vector': 'Universal Robots: the axis of one turn, as long as its angle',
    }
)
"""Orientation-angle conventions: each one's name and meaning (capitals: about fixed axes)."""

check_convention: Final = one_of('orientation convention', ORIENTATION_CONVENTIONS)

_ROTATION_VECTOR: Final = 'rotation_vector'

# Closer to gimbal lock than this, rad, two angles cannot be distinguished.
_LOCKED = 1e-7
_ORIGIN: Final = np.zeros(3)


def orientation_from_angles(angles: ArrayLike, convention: str = 'zyx') -> Array:
    """Orientation matrix of three orientation angles.

    Args:
        angles: (3,) rad, in the order of the convention's name, or the coordinates of a rotation vector.
        convention: One of `ORIENTATION_CONVENTIONS`.

    Returns:
        T, (3, 3): maps coordinates of the rotated frame to the reference frame.

    Raises:
        InvalidInputError: an unknown convention, or angles that are not three finite numbers.
    """
    vector = finite_vector(angles, 3, 'orientation angles')
    if convention == _ROTATION_VECTOR:
        return rotation_from_vector(vector)
    i, j, k = _axes(convention)
    a, b, c = vector.tolist()
    if convention.isupper():
        return _about(k, c) @ _about(j, b) @ _about(i, a)
    return _about(i, a) @ _about(j, b) @ _about(k, c)


def angles_from_orientation(T: ArrayLike, convention: str = 'zyx') -> Array:
    """Orientation angles of a matrix, inverse of `orientation_from_angles`.

    In gimbal lock, where only a sum or difference of two angles is determined, the third is zero (within
    1e-7 rad of it, at most that).

    Returns:
        (3,) rad; the second in [0, pi] where the first and the third axis are the same, else in
        [-pi/2, pi/2]. A rotation vector is at most pi long.

    Raises:
        InvalidInputError: an unknown convention, or `T` is not a rotation matrix.
    """
    T = rotation_matrix(T)
    if convention == _ROTATION_VECTOR:
        return rotation_vector(T)
    axes = _axes(convention)
    # T about fixed axes is the transpose of the turns back about the moved ones.
    angles = -_moved_axes_angles(T.T, *axes) if convention.isupper() else _moved_axes_angles(T, *axes)
    return angles + 0.0  # without the sign of zeros


@cache
def _axes(convention: str) -> tuple[int, int, int]:
    check_convention(convention)
    i, j, k = ('xyz'.index(axis) for axis in convention.lower())
    return i, j, k


def _about(axis: int, angle: float) -> Array:
    """Orientation after a turn about a coordinate axis, (3, 3)."""
    c, s = cos(angle), sin(angle)
    # A matrix is made of rows in a fraction of the time that its elements take one by one.
    if axis == 0:
        return np.array(((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c)))
    if axis == 1:
        return np.array(((c, 0.0, s), (0.0, 1.0, 0.0), (-s, 0.0, c)))
    return np.array(((c, -s, 0.0), (s, c, 0.0), (0.0, 0.0, 1.0)))


def _moved_axes_angles(T: Array, i: int, j: int, k: int) -> Array:
    """Angles a, b, c (3,) of T = Rot(i, a) Rot(j, b) Rot(k, c)."""
    first = 3 - i - j
    e = 1.0 if (j - i) % 3 == 1 else -1.0  # i x j = e first
    # Where the last axis points, seen along the first, gives a; in gimbal lock, along it, j gives it.
    along_j, along_first = T[j, k], T[first, k]
    if hypot(along_j, along_first) < _LOCKED:
        a = atan2(e * T[first, j], T[j, j])
    elif k == i:
        a = atan2(along_j, -e * along_first)
    else:
        a = atan2(-e * along_j, along_first)
    rest = _about(i, -a) @ T  # Rot(j, b) Rot(k, c)
    last = 3 - j - k
    f = 1.0 if (k - j) % 3 == 1 else -1.0  # j x k = f last
    b = atan2(f * rest[last, k], rest[k, k])
    c = atan2(f * rest[j, last], rest[j, j])
    return np.array([a, b, c])


def rotation_from_quaternion(quaternion: Array) -> Array:
    """Orientation matrix (3, 3) of a quaternion (x, y, z, w) of length 1, (4,)."""
    T: Array = pin.Quaternion(quaternion).toRotationMatrix()
    return T


def quaternion_of(T: Array) -> Array:
    """Quaternion (x, y, z, w) of an orientation matrix, (4,), with w >= 0."""
    # Each `pin.Quaternion(T)` leaves 80 bytes behind (pin 4.1.0).
    quaternion: Array = pin.SE3ToXYZQUAT(pin.SE3(T, _ORIGIN))[3:]
    return quaternion if quaternion[3] >= 0.0 else -quaternion


def quaternions_of(T: Array) -> Array:
    """As `quaternion_of`, of orientation matrices (m, 3, 3): (m, 4). Shepperd 1978."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = np.moveaxis(T, 0, -1)
    rows = np.array(
        [
            [1.0 + xx - yy - zz, yx + xy, zx + xz, zy - yz],
            [yx + xy, 1.0 - xx + yy - zz, zy + yz, xz - zx],
            [zx + xz, zy + yz, 1.0 - xx - yy + zz, yx - xy],
            [zy - yz, xz - zx, yx - xy, 1.0 + xx + yy + zz],
        ]
    )
    # Each row is the quaternion times four times one of its components: that of the largest is exact.
    largest = np.einsum('iim->im', rows).argmax(axis=0)
    row: Array = rows[largest, :, np.arange(len(T))]
    row /= np.where(row[:, 3] < 0.0, -1.0, 1.0)[:, None] * np.linalg.norm(row, axis=1, keepdims=True)
    return row


def rotation_vector(T: Array) -> Array:
    """Rotation vector (axis times angle, rad, angle in [0, pi]) of an orientation matrix, (3,)."""
    turn = pin.AngleAxis(T)
    vector: Array = turn.angle * turn.axis
    return vector


def rotation_vectors(T: Array) -> Array:
    """As `rotation_vector`, of orientation matrices (m, 3, 3): (m, 3)."""
    quaternions = quaternions_of(T)
    length = np.linalg.norm(quaternions[:, :3], axis=1)
    still = length == 0.0
    factor = np.where(still, 2.0, 2.0 * np.arctan2(length, quaternions[:, 3]) / np.where(still, 1.0, length))
    return factor[:, None] * quaternions[:, :3]


def rotation_vector_jacobians(vectors: Array) -> Array:
    """J (m, 3, 3) of rotation vectors p (m, 3): exp([p]) turns by J p', base frame, while p changes by p'.

    The left Jacobian of the rotation group (Chirikjian 2012, 10.86).
    """
    return np.array([pin.Jexp3(vector).T for vector in vectors])


def rotation_from_vector(vector: Array) -> Array:
    """Orientation matrix (3, 3) of a rotation vector (axis times angle, rad), (3,)."""
    T: Array = pin.exp3(vector)
    return T

"""Pose of a frame: position and orientation, and the error from one pose to another."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.orientation import (
    angles_from_orientation,
    orientation_from_angles,
    quaternion_of,
    rotation_from_quaternion,
    rotation_vector,
)
from robots_core.validation import Array, finite_vector, rotation_matrix


@dataclass(frozen=True, eq=False)
class Pose:
    """Position `r` (3,) in metres and orientation `T` (3, 3) of a frame, seen from a reference frame.

    `T` maps coordinates of the frame to the reference frame (ROS sense; Modelica's Orientation.T is
    its transpose). Both arrays are read-only.

    Raises:
        InvalidInputError: wrong shapes, values that are not finite, or `T` is not a rotation.
    """

    r: Array
    T: Array

    def __post_init__(self) -> None:
        _set(self, finite_vector(self.r, 3, 'r').copy(), rotation_matrix(self.T).copy())

    @classmethod
    def identity(cls) -> Pose:
        """The reference frame itself."""
        return cls(np.zeros(3), np.eye(3))

    @classmethod
    def from_angles(cls, r: ArrayLike, angles: ArrayLike, convention: str = 'zyx') -> Pose:
        """Pose from a position in metres and orientation angles in radians."""
        return cls(finite_vector(r, 3, 'r'), orientation_from_angles(angles, convention))

    @classmethod
    def from_quaternion(cls, r: ArrayLike, quaternion: ArrayLike) -> Pose:
        """Pose from a position in metres and a quaternion (x, y, z, w), normalised here.

        Raises:
            InvalidInputError: a quaternion of no usable length, or values that are not finite.
        """
        xyzw = finite_vector(quaternion, 4, 'quaternion')
        norm = math.hypot(*xyzw.tolist())
        if not 1e-9 <= norm <= 1e9:
            raise InvalidInputError(f'the quaternion has length {norm:.3g}; a rotation has length 1')
        return cls(finite_vector(r, 3, 'r'), rotation_from_quaternion(xyzw / norm))

    def angles(self, convention: str = 'zyx') -> Array:
        """Orientation angles, (3,) rad."""
        return angles_from_orientation(self.T, convention)

    def quaternion(self) -> Array:
        """Orientation as quaternion (x, y, z, w), (4,), with w >= 0."""
        return quaternion_of(self.T)

    def __matmul__(self, other: Pose) -> Pose:
        """Chain: `other` is seen from this frame; the result is seen from this frame's reference."""
        return valid_pose(self.r + self.T.dot(other.r), self.T.dot(other.T))  # `@` takes twice as long

    def inverse(self) -> Pose:
        """The reference frame seen from this frame."""
        return valid_pose(-self.T.T.dot(self.r), self.T.T)

    def error_to(self, target: Pose) -> Array:
        """Pose error (6,): translation (m), then rotation vector (rad), from here to `target`, base frame."""
        return np.concatenate([target.r - self.r, rotation_vector(target.T @ self.T.T)])

    def distance_to(self, target: Pose) -> tuple[float, float]:
        """Position distance in metres and rotation angle in radians to `target`."""
        error = self.error_to(target)
        return float(np.linalg.norm(error[:3])), float(np.linalg.norm(error[3:]))


def valid_pose(r: Array, T: Array) -> Pose:
    """The pose of arrays that no one else keeps and that are known to be valid: without a check."""
    pose = object.__new__(Pose)
    _set(pose, r, T)
    return pose


def _set(pose: Pose, r: Array, T: Array) -> None:
    """Give a pose its arrays, which become read-only."""
    r.setflags(write=False)
    T.setflags(write=False)
    object.__setattr__(pose, 'r', r)
    object.__setattr__(pose, 'T', T)

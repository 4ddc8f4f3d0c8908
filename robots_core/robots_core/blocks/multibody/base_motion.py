"""BaseMotion: orientation and motion of a robot's base."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robots_core.orientation import rotation_from_vector
from robots_core.validation import Array, finite_vector, read_only, rotation_matrix


@dataclass(frozen=True, eq=False)
class BaseMotion:
    """Orientation, velocity and acceleration of a robot's base; at rest and upright by default.

    A constant linear velocity has no effect on forces, so there is none.

    Attributes:
        T: Orientation of the base, (3, 3), maps base to world coordinates. The robot's gravity is that of a
            base that stands upright, T = identity.
        acceleration: Of the base's origin, (3,), m/s^2, in base axes; without gravity.
        angular_velocity: (3,), rad/s, in base axes.
        angular_acceleration: (3,), rad/s^2, in base axes.

    Raises:
        InvalidInputError: values that are not finite or of another shape, or `T` is no rotation.
    """

    T: Array = field(default_factory=lambda: np.eye(3))
    acceleration: Array = field(default_factory=lambda: np.zeros(3))
    angular_velocity: Array = field(default_factory=lambda: np.zeros(3))
    angular_acceleration: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, 'T', read_only(rotation_matrix(self.T)))
        for name in ('acceleration', 'angular_velocity', 'angular_acceleration'):
            object.__setattr__(self, name, read_only(finite_vector(getattr(self, name), 3, name)))

    @classmethod
    def ceiling(cls) -> BaseMotion:
        """A robot that hangs from the ceiling: turned by half a turn about x."""
        return cls(rotation_from_vector(np.array([np.pi, 0.0, 0.0])))

    @classmethod
    def wall(cls) -> BaseMotion:
        """A robot on a wall: turned by a quarter turn about y, its z along the world's x."""
        return cls(rotation_from_vector(np.array([0.0, 0.5 * np.pi, 0.0])))

    @property
    def turns(self) -> bool:
        """The base has an angular velocity or acceleration."""
        return bool(self.angular_velocity.any() or self.angular_acceleration.any())

    def free_fall(self, gravity: Array) -> Array:
        """Acceleration (3,), m/s^2, of free fall in base axes; `gravity` is that of an upright one."""
        return np.asarray(self.T.T @ gravity - self.acceleration)

"""Specific force and rotation: of a vehicle, and as a person in the cabin feels them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.validation import Array, finite_vector, read_only

GRAVITY: Final = 9.80665  # m/s^2, standard gravity


@dataclass(frozen=True, eq=False)
class VehicleMotion:
    """What an inertial measurement unit at a person's head measures, in the frame of the body around it.

    The frame is that of REP 103: x forward, y left, z up.

    Attributes:
        specific_force: Acceleration minus gravity, (3,) m/s^2; (0, 0, g) at rest.
        angular_velocity: (3,) rad/s.

    Raises:
        InvalidInputError: another shape, or NaN or infinity in one of them.
    """

    specific_force: Array
    angular_velocity: Array

    def __post_init__(self) -> None:
        for name in ('specific_force', 'angular_velocity'):
            object.__setattr__(self, name, read_only(finite_vector(getattr(self, name), 3, name)))

    @classmethod
    def at_rest(cls) -> VehicleMotion:
        """A body that stands level."""
        return cls(np.array([0.0, 0.0, GRAVITY]), np.zeros(3))

    @classmethod
    def of_body(cls, T: Array, acceleration: Array, angular_velocity: Array) -> VehicleMotion:
        """Of a body that moves.

        Args:
            T: Its orientation, (3, 3), body to inertial frame, whose z axis points up.
            acceleration: Of the head, (3,) m/s^2, inertial frame.
            angular_velocity: Of the body, (3,) rad/s, body frame.
        """
        return cls(T.T @ (acceleration + np.array([0.0, 0.0, GRAVITY])), angular_velocity)

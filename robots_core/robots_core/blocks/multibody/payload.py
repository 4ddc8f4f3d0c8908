"""Payload: a tool, a workpiece or both on the flange, and the one that a program has set."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array, bounded_vector, finite_vector, read_only

# Relative to the largest moment: figures of bodies are printed with some six digits.
INERTIA_TOLERANCE = 1e-6
LARGEST = 1e6  # kg, m, kg m^2


@dataclass(frozen=True, eq=False)
class Payload:
    """A rigid body fixed to tool0. `tool + workpiece` is the two as one.

    Attributes:
        mass: kg, not negative.
        center: Centre of mass in tool0, (3,), m.
        inertia: About the centre of mass, axes of tool0, (3, 3), kg m^2; zero: a point.

    Raises:
        InvalidInputError: a negative mass, or an inertia that no body has.
    """

    mass: float
    center: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))

    def __post_init__(self) -> None:
        if not 0.0 <= self.mass < np.inf:
            raise InvalidInputError(f'mass = {self.mass!r} kg must be a finite number, 0 or above')
        object.__setattr__(self, 'center', read_only(finite_vector(self.center, 3, 'center')))
        inertia = finite_vector(np.asarray(self.inertia, dtype=np.float64).ravel(), 9, 'inertia').reshape(
            3, 3
        )
        allowed = INERTIA_TOLERANCE * float(np.abs(inertia).max())
        moments = np.linalg.eigvalsh(0.5 * (inertia + inertia.T))
        if np.abs(inertia - inertia.T).max() > allowed or moments[0] < -allowed:
            raise InvalidInputError(f'inertia {inertia.tolist()} must be symmetric and not negative')
        if moments[2] > moments[0] + moments[1] + allowed:
            raise InvalidInputError(
                f'no body has principal moments {moments.tolist()}: the largest is at most the sum of the '
                'others'
            )
        object.__setattr__(self, 'inertia', read_only(inertia))

    def __add__(self, other: Payload) -> Payload:
        """Both as one body, by the parallel-axis theorem."""
        mass, inertia = self.mass + other.mass, self.inertia + other.inertia
        if mass == 0.0:
            return Payload(0.0, self.center, inertia)
        d = other.center - self.center
        steiner = self.mass * other.mass / mass * (d @ d * np.eye(3) - np.outer(d, d))
        return Payload(mass, self.center + other.mass / mass * d, inertia + steiner)

    def seen_from(self, pose: Pose) -> Payload:
        """The same body, where `pose` is that of tool0 in another frame; in that frame's coordinates."""
        return Payload(self.mass, pose.r + pose.T @ self.center, pose.T @ self.inertia @ pose.T.T)


def payload_of(values: Sequence[float], name: str = 'payload') -> Payload:
    """A payload from four or ten numbers: mass, centre x y z, and inertia xx xy xz yy yz zz if not a point.

    Raises:
        InvalidInputError: another count, values that are not finite, or that no body has; names them.
    """
    count = len(values)
    if count not in {4, 10}:
        raise InvalidInputError(
            f'{name} has {count} numbers; a payload is mass (kg) and centre x y z in tool0 (m), and then '
            f'maybe inertia xx xy xz yy yz zz (kg m^2)'
        )
    mass, x, y, z, *moments = bounded_vector(values, count, name, LARGEST, 'kg (m)').tolist()
    xx, xy, xz, yy, yz, zz = moments or np.zeros(6)
    return Payload(mass, np.array([x, y, z]), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


NOTHING = Payload(0.0)


class CarriedPayload:
    """Loads a model of the robot when the payload of the motion settings changes.

    Args:
        load: Makes the model carry a payload.
        values: What it carries at the start; unknown by default: then settings without a payload do not
            change it before there was one.
    """

    def __init__(self, load: Callable[[Payload], None], values: Sequence[float] = ()) -> None:
        self._load = load
        self._values = tuple(values)

    def carry(self, values: Sequence[float]) -> None:
        """Take the payload of the settings, by its numbers (see `payload_of`).

        Raises:
            InvalidInputError: numbers of no payload.
        """
        payload, wanted = payload_of(values), tuple(values)
        if wanted == self._values or (not self._values and payload.mass == 0.0):
            return
        self._values = wanted
        self._load(payload)

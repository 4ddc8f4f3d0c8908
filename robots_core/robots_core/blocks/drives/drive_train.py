"""DriveTrain: the interface of simulated drives, and ideal and second-order ones."""

from __future__ import annotations

from abc import ABC, abstractmethod
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.validation import Array, finite_vector, positive

if TYPE_CHECKING:
    from robots_core.blocks.floating_base.rendezvous import Rendezvous


class DriveTrain(ABC):
    """Drives of all axes of a robot. Implementations differ in the level of detail.

    Attributes:
        position: Joint positions, (n,), rad (m).
        velocity: Joint velocities, (n,), rad/s (m/s).
    """

    position: Array
    velocity: Array
    rendezvous: Rendezvous | None = None
    """What moves with the drives of a robot in orbit; None for a robot that stands."""
    led_by_reference_alone: bool = False
    """Nothing but the reference moves the axes: where a step changes nothing, no further one does."""
    can_be_pushed: bool = False
    """What presses on the robot moves the axes, see `push`."""

    @property
    def torque(self) -> Array | None:
        """Torques of the motors, at the joints, (n,), N m (N); None for drives without torques."""
        return None

    @abstractmethod
    def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
        """Follow the reference for one period.

        Args:
            q_ref: Reference positions at the end of the period, (n,), rad (m).
            q_dot_ref: Reference velocities there, (n,), rad/s; by default the difference quotient to `q_ref`.

        Returns:
            Positions and velocities (n,) at the end of the period.

        Raises:
            InvalidInputError: a reference of another shape or not finite.
        """

    def follow(self, references: Array, states: Array) -> None:
        """Follow finite references for several periods, as `step` does one after the other.

        Args:
            references: (k, 3, n): position, velocity, acceleration at the ends of the periods; not empty.
            states: Filled with positions, velocities and, where they are known, torques, (k, 2 or 3, n).
        """
        for reference, state in zip(references, states, strict=True):
            state[0], state[1] = self.step(reference[0], reference[1])
            if len(state) > 2:
                state[2] = self.torque

    def rest(self) -> None:
        """Stand still where the axes are: brakes hold them."""
        self.velocity = np.zeros_like(self.position)

    def hold(self) -> tuple[Array, Array]:
        """Stand still for one period, held by the brakes; returns positions and velocities (n,)."""
        return self.position, self.velocity

    def load(self, payload: Payload) -> None:  # noqa: B027  # most drives have no masses
        """Carry this payload from now on; it counts in drives with masses."""

    def push(self, torque: Array) -> None:  # noqa: B027
        """Torques on the joints from outside of the robot from now on, (n,), N m (N).

        They count in drives that can be pushed: J^T f of a wrench f on the tool.

        Raises:
            InvalidInputError: another shape, or NaN or infinity.
        """

    def apply_impact(self, q_dot: Array) -> None:  # noqa: B027
        """An impact has changed the velocities to `q_dot`, (n,), rad/s (m/s); see `impact_inertia`."""

    @property
    def impact_inertia(self) -> Array | None:
        """Inertia of the drives that an impact moves, (n,), kg m^2 (kg); None for joints that hold.

        Drives without masses have no limit of their torque: they hold.
        """
        return None


class IdealDrive(DriveTrain):
    """Drives that follow the reference exactly.

    Args:
        q: Joint positions at the start, (n,), rad (m), at rest.
        period: Time of one step, s.

    Raises:
        InvalidInputError: values that are not finite, or a period that is not positive.
    """

    led_by_reference_alone = True

    def __init__(self, q: ArrayLike, *, period: float) -> None:
        position = np.array(q, dtype=np.float64)
        self.position = finite_vector(position, position.size, 'q')
        self.velocity = np.zeros_like(position)
        self._period = positive(period, 'period', 's')

    def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
        """See `DriveTrain.step`."""
        n = self.position.size
        before, self.position = self.position, np.array(finite_vector(q_ref, n, 'q_ref'))
        self.velocity = (
            (self.position - before) / self._period
            if q_dot_ref is None
            else np.array(finite_vector(q_dot_ref, n, 'q_dot_ref'))
        )
        return self.position, self.velocity


class SecondOrderDrive(DriveTrain):
    """Drives that follow their reference as a second-order lag, each axis on its own.

    q_ddot = w^2 (q_ref - q) - 2 D w q_dot with w = 2 pi bandwidth. The step is the exact solution for a
    reference that is constant over the period, stable for any period; reference velocities are not used.

    Args:
        q: Joint positions at the start, (n,), rad (m), at rest.
        period: Time of one step, s.
        bandwidth: Natural frequency, Hz, one number or (n,).
        damping: Damping ratio D, one number or (n,); 1 does not overshoot.

    Raises:
        InvalidInputError: values that are not positive and finite, or of another shape.
    """

    led_by_reference_alone = True

    def __init__(
        self, q: ArrayLike, *, period: float, bandwidth: ArrayLike = 15.0, damping: ArrayLike = 1.0
    ) -> None:
        position = np.array(q, dtype=np.float64)
        n = position.size
        self.position, self.velocity = finite_vector(position, n, 'q'), np.zeros(n)
        positive(period, 'period', 's')
        w = 2.0 * np.pi * _per_axis(bandwidth, n, 'bandwidth')
        self._transition = _transition(w, _per_axis(damping, n, 'damping'), period).reshape(4, n)

    def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
        """See `DriveTrain.step`."""
        del q_dot_ref
        q_ref = finite_vector(q_ref, self.position.size, 'q_ref')
        a, b, c, d = self._transition
        error, q_dot = self.position - q_ref, self.velocity
        # From 0, so that standing axes have velocities of +0.
        self.position = 0.0 + a * error + b * q_dot + q_ref
        self.velocity = 0.0 + c * error + d * q_dot
        return self.position, self.velocity

    def follow(self, references: Array, states: Array) -> None:
        """See `DriveTrain.follow`."""
        # Imported on demand: a single step needs no compiler.
        kernel = import_module('robots_core.blocks.drives.second_order_kernel')
        kernel.follow(self._transition, self.position.copy(), self.velocity.copy(), references, states)
        self.position, self.velocity = states[-1].copy()


def _transition(w: Array, D: Array, period: float) -> Array:
    """Transition matrices of position and velocity over a period, (2, 2, n).

    The exponential of [[0, 1], [-w^2, -2 D w]] period, of its two eigenvalues, which may be complex or meet.
    """
    root = w * np.sqrt(D * D - 1.0 + 0j)
    z = 2.0 * root * period  # how far the eigenvalues are apart
    met = z == 0.0
    spread = np.where(met, 1.0, -np.expm1(-z) / np.where(met, 1.0, z))
    fast = np.exp(root * period - D * w * period)
    mean = (0.5 * fast * (1.0 + np.exp(-z))).real
    slope = (period * fast * spread).real
    return np.array([[mean + D * w * slope, slope], [-w * w * slope, mean - D * w * slope]])


def _per_axis(values: ArrayLike, n: int, name: str) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 1 and array.size == 1:
        array = array[0]
    array = np.broadcast_to(array, (n,)) if array.ndim == 0 else array
    if array.shape != (n,):
        raise InvalidInputError(f'{name} must be one number or {n}, got {array.size}')
    for value in array:
        positive(float(value), name)
    return array

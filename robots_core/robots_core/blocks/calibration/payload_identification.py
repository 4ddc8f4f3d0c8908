"""The payload of a robot, identified from the torques of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robots_core.blocks.calibration.motion_samples import MotionSamples
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError, MeasurementError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

LARGEST_MASS_ERROR: Final = 0.05  # of the mass
LARGEST_CENTER_ERROR: Final = 0.02  # m
SLOWEST: Final = 0.005
"""Of an axis' velocity limit: below it friction may have any value, and the torque says nothing."""
NOISE: Final = 1e-4
"""Of an axis' torque limit: no torque is measured better than that."""
PARAMETERS: Final = 10  # mass, first moments, inertia about tool0, as in Pinocchio's `bodyRegressor`
PRIOR: Final = 1e-12
"""Of the largest information of a parameter: what a motion does not excite counts as 0."""
ROUNDS: Final = 3


@dataclass(frozen=True, eq=False)
class IdentifiedPayload:
    """A payload and how well it is known; arrays are read-only.

    Attributes:
        payload: Mass and centre of mass; without inertia.
        covariance: Of mass and centre x, y, z, (4, 4), kg and m.
        torque_error: What the fit leaves of the torques, rms by axis, (n,), N m (N); 0 for one that stood.
    """

    payload: Payload
    covariance: Array
    torque_error: Array

    @property
    def mass_std(self) -> float:
        """Standard deviation of the mass, kg."""
        return float(np.sqrt(self.covariance[0, 0]))

    @property
    def center_std(self) -> Array:
        """Standard deviation of the centre of mass, (3,), m."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[1:]))


def identify_payload(robot: BaseRobotModel, samples: MotionSamples) -> IdentifiedPayload:
    """Mass and centre of mass of all that the flange carries, from a motion in which it is turned.

    The torques, less those of the robot without payload, are linear in mass, first moments and inertia of the
    payload (Atkeson, An and Hollerbach 1986). Coulomb and viscous friction of each axis are estimated
    too, as corrections of the model's, so axes should move in both directions. Least squares, weighted by
    what the fit leaves of each axis; errors that persist from sample to sample count as fewer samples.

    Args:
        robot: The robot; its `axes_data` has friction and rotors.
        samples: The motion.

    Raises:
        InvalidInputError: another number of axes, or a robot whose dynamics are not those of its bodies.
        MeasurementError: the motion excites mass or centre of mass too little; names what remains uncertain.
    """
    n = robot.num_axes
    if samples.q.shape[1] != n:
        raise InvalidInputError(f'the samples have {samples.q.shape[1]} axes, the robot has {n}')
    A, rest = _equations(robot, samples)
    moves = np.abs(samples.q_dot) > SLOWEST * robot.axes_data.velocity
    if moves.sum() <= 4 * A.shape[2]:
        raise MeasurementError(
            f'the axes move in {int(moves.sum())} values of the recording, which is too short; needed are '
            f'over {4 * A.shape[2]}: move several axes in both directions',
            key='short_motion',
            count=int(moves.sum()),
            fewest=4 * A.shape[2],
        )
    x, covariance, errors = _solve(A, rest, moves, NOISE * robot.axes_data.effort)
    return _checked(x, covariance, errors)


def _equations(robot: BaseRobotModel, samples: MotionSamples) -> tuple[Array, Array]:
    """Torques (k, n) beyond those of the robot alone, and (k, n, 10 + 2 n) what they are linear in."""
    dynamics = NumericalDynamics(robot)
    n = robot.num_axes
    A = np.zeros((*samples.q.shape, PARAMETERS + 2 * n))
    rest = np.empty(samples.q.shape)
    axes = np.arange(n)
    motion = zip(samples.q, samples.q_dot, samples.q_ddot, samples.tau, strict=True)
    for k, (q, q_dot, q_ddot, tau) in enumerate(motion):
        rest[k] = tau - dynamics.torques(q, q_dot, q_ddot)
        T, J, J_der = robot.orientation_and_jacobians(q, q_dot)
        twist, acceleration = J @ q_dot, J @ q_ddot + J_der @ q_dot
        acceleration[:3] -= dynamics.gravity
        # In a frame whose origin moves with the body at this instant: the torques do not depend on its speed.
        spatial = pin.Motion(T.T @ acceleration[:3], T.T @ acceleration[3:])
        wrenches = pin.bodyRegressor(pin.Motion(np.zeros(3), T.T @ twist[3:]), spatial)
        A[k, :, :PARAMETERS] = np.concatenate([T.T @ J[:3], T.T @ J[3:]]).T @ wrenches
        A[k, axes, PARAMETERS + axes] = np.sign(q_dot)
        A[k, axes, PARAMETERS + n + axes] = q_dot
    return A, rest


def _solve(A: Array, rest: Array, moves: NDArray[np.bool_], noise: Array) -> tuple[Array, Array, Array]:
    """Parameters, their covariance, and the rms of what the fit leaves, by axis."""
    n = A.shape[1]
    errors, longer = np.array(noise), np.ones(n)
    x, inverse = np.zeros(A.shape[2]), np.zeros((A.shape[2],) * 2)
    for _ in range(ROUNDS):
        information, right = np.zeros_like(inverse), np.zeros_like(x)
        for axis in range(n):
            rows, values = A[moves[:, axis], axis], rest[moves[:, axis], axis]
            weight = 1.0 / (errors[axis] ** 2 * longer[axis])
            information += weight * rows.T @ rows
            right += weight * rows.T @ values
        diagonal = np.diag(information)
        scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        scaled = scale[:, None] * information * scale
        inverse = scale[:, None] * np.linalg.inv(scaled + PRIOR * np.eye(len(x))) * scale
        x = inverse @ right
        for axis in range(n):
            left = rest[moves[:, axis], axis] - A[moves[:, axis], axis] @ x
            errors[axis] = max(noise[axis], np.sqrt((left**2).mean()) if len(left) else 0.0)
            longer[axis] = _persistence(left)
    return x, inverse, np.where(moves.any(axis=0), errors, 0.0)


def _persistence(errors: Array) -> float:
    """Samples that count as one, by the correlation of neighbours."""
    if len(errors) < 3 or not errors.any():
        return 1.0
    rho = min(max(float(errors[1:] @ errors[:-1] / (errors @ errors)), 0.0), 0.98)
    return (1.0 + rho) / (1.0 - rho)


def _checked(x: Array, covariance: Array, errors: Array) -> IdentifiedPayload:
    mass, mass_std = float(x[0]), float(np.sqrt(covariance[0, 0]))
    if mass <= 2.0 * mass_std:
        raise MeasurementError(
            f'the mass {mass:.3g} kg with a standard deviation of {mass_std:.2g} kg cannot be distinguished '
            'from 0: nothing is carried, or the motion excites it too little; move axes that lift it, in '
            'both directions',
            key='no_mass',
            mass=mass,
            std=mass_std,
        )
    center = x[1:4] / mass
    # d(center) = (d(moments) - center d(mass)) / mass
    change = np.eye(4)
    change[1:, 0], change[1:, 1:] = -center / mass, np.eye(3) / mass
    found = change @ covariance[:4, :4] @ change.T
    worst = float(np.sqrt(np.linalg.eigvalsh(found[1:, 1:])[-1]))
    if mass_std > LARGEST_MASS_ERROR * mass:
        raise MeasurementError(
            f'the mass {mass:.3g} kg has a standard deviation of {mass_std:.2g} kg; valid is at most '
            f'{100.0 * LARGEST_MASS_ERROR:g} %: move axes that lift it further, in both directions',
            key='uncertain_mass',
            mass=mass,
            std=mass_std,
            bound=LARGEST_MASS_ERROR,
        )
    if worst > LARGEST_CENTER_ERROR:
        direction = 'xyz'[int(np.abs(np.linalg.eigh(found[1:, 1:])[1][:, -1]).argmax())]
        raise MeasurementError(
            f'the centre of mass has a standard deviation of {1e3 * worst:.0f} mm, most along {direction} of '
            f'tool0; valid is at most {1e3 * LARGEST_CENTER_ERROR:g} mm: turn the last axes further, in both '
            f'directions, so that {direction} of tool0 is level and then upright',
            key='uncertain_center',
            std=worst,
            direction=direction,
            bound=LARGEST_CENTER_ERROR,
        )
    payload = Payload(mass, read_only(center))
    return IdentifiedPayload(payload, read_only(found), read_only(errors))

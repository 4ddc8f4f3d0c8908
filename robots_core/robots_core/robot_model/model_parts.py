"""What a robot model consists of: kinematics, dynamics, shapes, and dimensions (the paper's records)."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite

import numpy as np
import pinocchio as pin

from robots_core.robot_model.allowed_pairs import AllowedPairs
from robots_core.robot_model.shapes import Shape
from robots_core.validation import FLOAT64, Array, finite_motion, finite_state, finite_vector, read_only


class KinematicModel:
    """The paper's KinematicModel: coordinate frames of every axis for given joint positions.

    They are computed by Pinocchio, whose model has one position per joint.
    """

    def __init__(self, model: pin.Model) -> None:
        self._model = model
        self._data = model.createData()

    def frame_axes(self, q: Array) -> tuple[Array, Array]:
        """Frames of all axes, seen from the base.

        The frame of axis i sits on the axis and moves with the body behind it.

        Args:
            q: Joint positions, (n,), rad (m).

        Returns:
            r: Origins, (n, 3), m.
            T: Orientations, (n, 3, 3), axis frame to base.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        n = self._model.nv
        pin.forwardKinematics(self._model, self._data, finite_vector(q, n, 'q'))
        r, T = np.empty((n, 3)), np.empty((n, 3, 3))
        for axis in range(n):
            placement = self._data.oMi[axis + 1]
            r[axis], T[axis] = placement.translation, placement.rotation
        return r, T


class RigidDynamicsModel:
    """The paper's RigidDynamicsModel: joint torques of the rigid multibody chain under gravity.

    Recursive Newton-Euler and composite rigid body algorithms (Featherstone 2008) by Pinocchio, whose model
    has one position per joint. Every method raises InvalidInputError for an argument of another shape or not
    finite.

    Attributes:
        masses: (n + 1,) kg; entry 0 is the base, entry i the body moved by axis i.
        centers_of_mass: (n + 1, 3) m, each in its body's axis frame.
        inertias: (n + 1, 3, 3) kg m^2, each about its centre of mass, axes of its axis frame.
        gravity: Acceleration of free fall in the base frame, (3,), m/s^2.
    """

    def __init__(self, model: pin.Model) -> None:
        self._model = model
        self._data = model.createData()
        self._n = model.nv
        bodies = list(model.inertias)
        self.masses = read_only([body.mass for body in bodies])
        self.centers_of_mass = read_only([body.lever for body in bodies])
        self.inertias = read_only([body.inertia for body in bodies])
        self.gravity = read_only(model.gravity.linear)

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """See `BaseRobotModel.rigid_dynamics`."""
        model, data = self._model, self._data
        try:  # as in `of_motion`
            M, tau_aux = pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, q_dot)
            if (
                q.dtype is q_dot.dtype is q_ddot.dtype is FLOAT64
                and q.ndim == q_dot.ndim == q_ddot.ndim == 1
                and isfinite(sum(q.tolist(), sum(q_dot.tolist(), sum(q_ddot.tolist()))))
            ):
                return M.dot(q_ddot) + tau_aux, M, tau_aux  # `@` takes twice as long
        except (AttributeError, TypeError, ValueError):
            pass
        q, q_dot, q_ddot = finite_motion(q, q_dot, q_ddot, self._n)
        M, tau_aux = pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, q_dot)
        return M.dot(q_ddot) + tau_aux, M, tau_aux

    def torques(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """Joint torques (n,), N m, for a motion: inverse dynamics."""
        return of_motion(pin.rnea, self._model, self._data, q, q_dot, q_ddot)

    def mass_matrix(self, q: Array) -> Array:
        """Joint-space mass matrix (n, n), kg m^2, symmetric and positive definite."""
        # From Python, Pinocchio hands out both triangles.
        return np.asarray(pin.crba(self._model, self._data, finite_vector(q, self._n, 'q')))

    def bias_torques(self, q: Array, q_dot: Array) -> Array:
        """Torques (n,), N m, of Coriolis, centrifugal and gravitational forces."""
        q, q_dot = finite_state(q, q_dot, self._n)
        return np.asarray(pin.nonLinearEffects(self._model, self._data, q, q_dot))


def of_motion(  # noqa: PLR0917  # in the order of Pinocchio's functions
    function: Callable[..., Array], model: pin.Model, data: pin.Data, q: Array, q_dot: Array, x: Array
) -> Array:
    """`function(model, data, q, q_dot, x)`, one of `pin.rnea` and `pin.aba`, with arguments (n,) checked.

    The model has one position per joint.

    Raises:
        InvalidInputError: an argument of another shape or not finite.
    """
    # A check of the result takes less time than one of the arguments. Pinocchio rejects arrays of another
    # size, but accepts columns and misreads another byte order. Its result is finite only if q and x are;
    # the speed of a single axis that slides has no effect on it.
    try:
        result = function(model, data, q, q_dot, x)
        if (
            q.dtype is q_dot.dtype is x.dtype is FLOAT64
            and q.ndim == q_dot.ndim == x.ndim == 1
            and isfinite(sum(result.tolist(), sum(q_dot.tolist())))
        ):
            return result
    except (AttributeError, TypeError, ValueError):
        pass
    return function(model, data, *finite_motion(q, q_dot, x, model.nv))


@dataclass(frozen=True)
class RobotVisualization:
    """Visual shapes. Holds no kinematics: place each shape with `KinematicModel.frame_axes`."""

    shapes: tuple[Shape, ...]


@dataclass(frozen=True)
class CollisionModel:
    """Shapes for collision checks. Holds no kinematics: place them with `KinematicModel.frame_axes`.

    Attributes:
        shapes: The robot's body.
        allowed_pairs: Pairs of its shapes that need no check, as stored with the robot; None where nothing
            is stored, they are then found when they are needed.
    """

    shapes: tuple[Shape, ...]
    allowed_pairs: AllowedPairs | None = None


@dataclass(frozen=True)
class StructuralData:
    """Base of a robot's own record of dimensions: lengths, offsets, masses.

    The paper prescribes no names here; a robot subclasses this with frozen fields and their units.
    `source` says where the figures come from and what is estimated.
    """

    source: str = ''

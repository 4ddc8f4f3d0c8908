"""RigidDynamicsModel: the chain with its masses and inertias."""

from abc import ABC, abstractmethod

from robots_core.validation import Array, read_only


class RigidDynamicsModel(ABC):
    """The paper's RigidDynamicsModel: joint torques of the rigid multibody chain under gravity.

    Every method raises InvalidInputError for an argument of another shape or not finite.

    Attributes:
        masses: (n + 1,) kg; entry 0 is the base, entry i the body moved by axis i.
        centers_of_mass: (n + 1, 3) m, each in its body's axis frame.
        inertias: (n + 1, 3, 3) kg m^2, each about its centre of mass, axes of its axis frame.
        gravity: Acceleration of free fall in the base frame, (3,), m/s^2; that of an upright base by default.
    """

    masses: Array
    centers_of_mass: Array
    inertias: Array
    gravity: Array = read_only((0.0, 0.0, -9.81))

    @abstractmethod
    def torques(self, q: Array, q_dot: Array, q_ddot: Array) -> Array:
        """Joint torques (n,), N m, for a motion: inverse dynamics."""

    @abstractmethod
    def mass_matrix(self, q: Array) -> Array:
        """Joint-space mass matrix (n, n), kg m^2, symmetric and positive definite."""

    @abstractmethod
    def bias_torques(self, q: Array, q_dot: Array) -> Array:
        """Torques (n,), N m, of Coriolis, centrifugal and gravitational forces."""

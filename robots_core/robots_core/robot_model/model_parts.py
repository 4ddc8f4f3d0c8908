"""What a robot model consists of: kinematics, dynamics, shapes, and dimensions (the paper's records)."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from robots_core.robot_model.allowed_pairs import AllowedPairs
from robots_core.robot_model.shapes import Shape
from robots_core.validation import Array, read_only


class KinematicModel(ABC):
    """The paper's KinematicModel: coordinate frames of every axis for given joint positions."""

    @abstractmethod
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

"""BaseRobotModel: the interface of every robot plugin (the paper's partial package `baseRobotModel`)."""

from abc import ABC, abstractmethod

import numpy as np

from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.pose import Pose, valid_pose
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.drive_data import DriveData
from robots_core.robot_model.model_parts import (
    CollisionModel,
    KinematicModel,
    RigidDynamicsModel,
    RobotVisualization,
    StructuralData,
)
from robots_core.validation import Array


class BaseRobotModel(ABC):
    """One serial robot: numpy in, numpy out, SI units, radians.

    Everything robot specific is behind this interface, so that every block works with any robot.
    Plugins register a class or a function without arguments under the entry-point group
    `robots_core.robot_models`. An instance keeps scratch memory: use one per thread. Its figures do not
    change, and blocks keep what they compute of them; instances are compared by identity (of a dataclass:
    `eq=False`).
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """The robot's name, as in its entry point."""

    @property
    @abstractmethod
    def axes_data(self) -> AxesData:
        """Limits and drive data per axis."""

    @property
    @abstractmethod
    def structural_data(self) -> StructuralData:
        """Mechanical dimensions, in the robot author's own words."""

    @property
    @abstractmethod
    def kinematic_model(self) -> KinematicModel:
        """The chain of axis frames."""

    @property
    @abstractmethod
    def rigid_dynamics_model(self) -> RigidDynamicsModel:
        """The chain with masses and inertias."""

    @property
    @abstractmethod
    def visualization(self) -> RobotVisualization:
        """Visual shapes."""

    @property
    @abstractmethod
    def collision_model(self) -> CollisionModel:
        """Shapes for collision checks."""

    @property
    @abstractmethod
    def description(self) -> str:
        """The robot as URDF text, as published on `robot_description`."""

    @property
    @abstractmethod
    def home(self) -> Array:
        """Joint positions inside the limits to start from, (n,), read-only."""

    @property
    def substitutions(self) -> tuple[str, ...]:
        """What the robot's files lack, and what was taken in its place, one sentence each."""
        return ()

    @property
    def drive_data(self) -> DriveData:
        """Motors, gears and their controllers; by default those of `DriveData.from_limits`."""
        return DriveData.from_limits(self.axes_data)

    @property
    def orientation_convention(self) -> str:
        """Orientation-angle convention of the robot's maker, one of `ORIENTATION_CONVENTIONS`."""
        return 'zyx'

    @property
    def base_link(self) -> Pose:
        """The frame `base_link` of messages, seen from the base; the base itself unless the maker differs."""
        return Pose.identity()

    @property
    def num_axes(self) -> int:
        """Number of axes n."""
        return self.axes_data.num_axes

    @abstractmethod
    def direct_kinematics(self, q: Array) -> tuple[Array, Array]:
        """Pose of tool0 in the base frame.

        Args:
            q: Joint positions, (n,), rad (m); not checked against the limits.

        Returns:
            r: Position, (3,), m.
            T: Orientation, (3, 3), maps tool coordinates to base coordinates.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """

    def pose(self, q: Array) -> Pose:
        """`direct_kinematics` as a pose, which needs no check."""
        r, T = self.direct_kinematics(q)
        return valid_pose(r.copy(), T.copy())

    def tool_poses(self, q: Array) -> tuple[Array, Array]:
        """`direct_kinematics` at many joint positions, equal to rounding.

        Args:
            q: Joint positions, (m, n), rad (m).

        Returns:
            Positions, (m, 3), m, and orientations, (m, 3, 3).
        """
        r, T = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
        for row, position in enumerate(q):
            r[row], T[row] = self.direct_kinematics(position)
        return r, T

    @abstractmethod
    def jacobian(self, q: Array) -> Array:
        """Geometric Jacobian (6, n) at tool0, base frame: linear rows (m/s), then angular (rad/s)."""

    @abstractmethod
    def jacobian_der(self, q: Array, q_dot: Array) -> Array:
        """Time derivative (6, n) of the Jacobian for joint velocities `q_dot` (n,)."""

    def orientation_and_jacobians(self, q: Array, q_dot: Array) -> tuple[Array, Array, Array]:
        """Orientation T (3, 3) of `direct_kinematics`, `jacobian` and `jacobian_der`, equal to rounding."""
        J_der = self.jacobian_der(q, q_dot)
        return self.direct_kinematics(q)[1], self.jacobian(q), J_der

    @abstractmethod
    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """Joint torques of the rigid robot.

        Args:
            q: Joint positions, (n,), rad (m).
            q_dot: Joint velocities, (n,), rad/s.
            q_ddot: Joint accelerations, (n,), rad/s^2.

        Returns:
            tau: Torques (n,), N m (N); tau = M q_ddot + tau_aux.
            M: Mass matrix (n, n).
            tau_aux: Torques of Coriolis, centrifugal and gravitational forces, (n,).

        Raises:
            InvalidInputError: an argument of another shape or not finite.
        """

    def inverse_kinematics_analytic(self, r: Array, T: Array, *, q_near: Array | None = None) -> Array:
        """All joint configurations inside the limits that reach a pose, where a closed form exists.

        Args:
            r: Position of tool0 in the base frame, (3,), m.
            T: Orientation of tool0, (3, 3).
            q_near: Joint positions, (n,); each solution has the full turns nearest to them. Axes that a
                singular pose leaves undetermined (a straight wrist, a wrist point on axis 1) keep these
                positions. Home by default.

        Returns:
            (k, n) rad, one row per branch; k = 0 if nothing inside the limits reaches the pose. A singular
            pose is reached by one representative of each family of solutions.

        Raises:
            NoAnalyticInverseKinematicsError: the robot has no closed form; names the reason.
            InvalidInputError: values that are not finite, of the wrong shape, or `T` is no rotation.
        """
        del r, T, q_near
        raise NoAnalyticInverseKinematicsError(
            f'robot {self.name!r} has no analytic inverse kinematics; use DampedLeastSquares'
        )

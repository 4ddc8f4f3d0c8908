"""TrajectoryGenerator: what all planners have in common, those of third parties too."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypedDict, cast

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import (
    HeldInverseKinematics,
    inverse_kinematics_for,
)
from robots_core.blocks.inverse_kinematics.hold import POSE, describe_miss, held_by, missing_directions
from robots_core.errors import InvalidInputError, PlanningError, UnreachablePoseError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.trajectory import Trajectory

if TYPE_CHECKING:
    from robots_core.blocks.collision_detection import CollisionDetection
    from robots_planning.motion_settings import MotionSettings

# Plans stay this fraction inside the limits, which covers rounding and resampling.
LIMIT_MARGIN = 1e-4
REST_DURATION = 0.01  # s, of a motion between equal positions
END_TOLERANCE = 1e-9  # rad (m); inverse kinematics converges to 1e-10
FARTHEST = 20.0  # m; coordinates beyond it are taken for millimetres in messages
Target = Pose | Sequence[Pose] | ArrayLike
"""Pose or poses of the tool, or joint positions (n,)."""


class ToolGeometry(TypedDict, total=False):
    """What verification compares the tool's path with: arguments of `verify`."""

    line: tuple[Pose, Pose]
    path: CartesianPath
    oriented: bool


class TrajectoryGenerator(ABC):
    """A planner: validate the command, plan it, check the plan.

    Args:
        robot: The robot.
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration and jerk limits to use, in (0, 1].
        tool: Pose of the tool centre point in tool0, which target poses are meant for; tool0 by default.
        hold: What of target poses is held, see `held_by`; what the arm can by default.

    Raises:
        InvalidInputError: a fraction outside (0, 1], or a `hold` that does not exist.
    """

    kinds: ClassVar[tuple[str, ...]] = ()
    """Names of the kinds of motion that it plans, see `MOTION_KINDS`."""
    starts_moving: ClassVar[bool] = False
    """It has `generate_moving`."""
    keeps_torque: bool = False
    """Its plans keep the axes' torque limits; verification then checks them."""

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        speed_fraction: float = 1.0,
        acceleration_fraction: float = 1.0,
        tool: Pose | None = None,
        hold: str = '',
    ) -> None:
        self.robot = robot
        self.via: Array | None = None
        """Postures (k, n) that the last path around obstacles leads along; None of other planners."""
        self.hold = held_by(robot.num_axes, hold)
        self.tool = tool
        self.speed_fraction = usable_fraction(speed_fraction, 'speed_fraction')
        self.acceleration_fraction = usable_fraction(acceleration_fraction, 'acceleration_fraction')
        axes = robot.axes_data
        self.velocity = axes.velocity * self.speed_fraction * (1.0 - LIMIT_MARGIN)
        self.acceleration = axes.acceleration * self.acceleration_fraction * (1.0 - LIMIT_MARGIN)
        self.jerk = axes.jerk * self.acceleration_fraction * (1.0 - LIMIT_MARGIN)

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """The planner for modal settings.

        Args:
            robot: The robot.
            settings: What holds for the motion.
            options: Further arguments of the class.

        Raises:
            InvalidInputError: settings that the robot or the planner cannot keep.
        """
        return cls(
            robot,
            speed_fraction=settings.speed_fraction,
            acceleration_fraction=settings.acceleration_fraction,
            tool=settings.tool_offset,
            **({'hold': settings.hold} if settings.hold else {}),
            **options,
        )

    @cached_property
    def inverse_kinematics(self) -> DampedLeastSquares | HeldInverseKinematics:
        """Of the tool centre point; made when it is first needed."""
        return inverse_kinematics_for(self.robot, tool=self.tool, hold=self.hold)

    def generate(self, q_start: ArrayLike, target: Target) -> Trajectory:
        """Plan a motion from rest to rest.

        Args:
            q_start: Joint positions to start from, (n,), rad (m).
            target: Pose of the tool in the base frame, or joint positions (n,), rad (m); of motions through
                several poses these in the order of the motion, without the start.

        Raises:
            JointLimitError: start or target outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the (last) pose.
            PlanningError: the motion between start and target is impossible; says where and why.
            InvalidInputError: wrong shapes, NaN or infinity, or a kind of target not meant for this motion.
        """
        start = self.robot.axes_data.check_position(q_start, 'q_start')
        trajectory = self._plan(start, target)
        self._check(trajectory, start)
        return trajectory

    def _plan(self, start: Array, target: Target) -> Trajectory:
        """Plan to a target that is not checked yet; the start is valid."""
        if isinstance(target, Pose):
            return self.plan_to_pose(start, target)
        goal = self.robot.axes_data.check_position(cast('ArrayLike', target), 'target')
        return self.plan_to_joints(start, goal)

    @abstractmethod
    def plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """Plan to a pose of the tool; the start is valid."""

    def plan_to_joints(self, start: Array, target: Array) -> Trajectory:  # noqa: ARG002  # a hook
        """Plan to joint positions; both ends are valid.

        Raises:
            InvalidInputError: the planner takes poses alone.
        """
        raise InvalidInputError(
            f'{type(self).__name__} needs a Pose as target; joint targets are for motions in joint space'
        )

    def generate_moving(
        self,
        motion: tuple[ArrayLike, ArrayLike, ArrayLike],  # noqa: ARG002  # a hook
        target: Target,  # noqa: ARG002
    ) -> Trajectory:
        """Plan a motion from a robot that moves, to rest.

        Args:
            motion: Joint positions, velocities and accelerations to start from, (n,) each.
            target: As for `generate`.

        Raises:
            InvalidInputError: the planner starts from rest only; or as `generate`.
        """
        raise InvalidInputError(f'{type(self).__name__} cannot start from a robot that moves')

    def surround(  # noqa: B027  # a hook
        self, collision: CollisionDetection | None, margin: float, cancelled: Callable[[], bool]
    ) -> None:
        """Take what a planner needs that plans around obstacles; others have no use for it.

        Args:
            collision: Of the robot in its current scene; None where nothing checks for collisions.
            margin: Distance that motions keep, m, from 0.
            cancelled: Whether the motion that is being planned was given up; for plans that take long.
        """

    def joint_path(self, start: Array, target: Target) -> JointPath | None:  # noqa: ARG002  # a hook
        """The path of the axes that a motion alone would take, so that it can run through to the next.

        Returns:
            The path; None if there is none or the axes stand still on it: then the robot stops at the end.

        Raises:
            PlanningError: the motion goes nowhere, or as `generate`.
        """
        return None

    def geometry(self, start: Pose, target: Target) -> ToolGeometry:  # noqa: ARG002  # a hook
        """What verification compares the tool path from pose `start` with; nothing by default."""
        return {}

    def _check(self, trajectory: Trajectory, start: Array) -> None:
        """Check that a plan starts at the commanded positions and is at rest at both ends."""
        rates = trajectory.velocity, trajectory.acceleration
        ends = [value for rows in rates for row in (0, -1) for value in rows[row].tolist()]
        off = max(map(abs, (trajectory.position[0] - start).tolist()))
        if any(ends) or off > END_TOLERANCE:
            moving = max(map(abs, ends))
            raise PlanningError(
                f'{type(self).__name__} made a plan that starts {off:.3g} rad off or does not rest at its '
                f'ends ({moving:.3g}); allowed are {END_TOLERANCE:g} and 0',
                start_error=off,
                end_motion=moving,
            )

    def reach(self, pose: Pose, q_start: Array) -> Array:
        """Joint positions (n,) for a pose, in the configuration that the search from `q_start` finds.

        Raises:
            UnreachablePoseError: names the distance to the closest reachable pose.
        """
        result = self.inverse_kinematics.solve(pose, q_start)
        if not result.converged:
            x, y, z = (float(value) for value in pose.r)
            oriented = ' with the commanded orientation' if self.hold == POSE else ''
            raise UnreachablePoseError(
                f'{self.robot.name} cannot reach position ({x:.4f}, {y:.4f}, {z:.4f}) m{oriented} inside its '
                f'axis limits: the closest pose found is {describe_miss(result, self.hold)} off'
                f'{missing_directions(self.robot, result.q, self.hold)}'
                f'{self._unit_hint(pose, q_start)}',
                x=x,
                y=y,
                z=z,
                position_error=result.position_error,
                orientation_error=result.orientation_error,
            )
        return result.q

    def _unit_hint(self, pose: Pose, q_start: Array) -> str:
        """The end of a message where lengths look like millimetres; '' where they do not."""
        far = np.abs(pose.r) > FARTHEST
        if not far.any():
            return ''
        r = np.where(far, 1e-3 * pose.r, pose.r)
        if not self.inverse_kinematics.solve(Pose(r, pose.T), q_start).converged:
            return '; lengths are metres'
        return f'; lengths are metres: ({", ".join(f"{value:.4g}" for value in r)})?'


def usable_fraction(value: float, name: str) -> float:
    """`value` if it is in (0, 1].

    Raises:
        InvalidInputError: outside, NaN or infinite.
    """
    if not positive(value, name) <= 1.0:
        raise InvalidInputError(f'{name} = {value!r} must be in (0, 1]')
    return float(value)


def rest_trajectory(start: Array, target: Array) -> Trajectory:
    """A short trajectory between two points that are the same, or closer than rounding."""
    zero = np.zeros((2, len(start)))
    return Trajectory(np.array([0.0, REST_DURATION]), np.stack([start, target]), zero, zero)

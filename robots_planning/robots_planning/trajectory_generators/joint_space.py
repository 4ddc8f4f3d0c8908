"""JointSpaceGenerator: the base class of point-to-point motions of the axes."""

from functools import cached_property
from operator import truediv
from typing import Any, ClassVar, Self, cast

import numpy as np
from numpy.typing import ArrayLike
from ruckig import Synchronization

from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import HeldInverseKinematics
from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.errors import (
    InvalidInputError,
    NoAnalyticInverseKinematicsError,
    PlanningError,
    UnreachablePoseError,
)
from robots_core.pose import Pose
from robots_core.robot_model.analytic.configuration import Configuration
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector
from robots_planning.motion_settings import MotionSettings, known_configuration
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.state_to_rest_profile import NANOSECOND, NoProfileError, StateToRestProfile
from robots_planning.trajectory import Trajectory, one_after_another
from robots_planning.trajectory_generators.braking import check_start_motion
from robots_planning.trajectory_generators.trajectory_generator import (
    LIMIT_MARGIN,
    Target,
    TrajectoryGenerator,
    rest_trajectory,
)
from robots_planning.verification.trajectory_verification import LONGEST_MOTION

SHORTEST_MOVE = 1e-9  # rad (m) of the axis that moves most; shorter ones are rounding of the target
TURN = 2.0 * np.pi
LARGEST_ANGLE = 10.0  # rad, of a continuous axis, at which rounding is estimated


class JointSpaceGenerator(TrajectoryGenerator):
    """Point-to-point motion of the axes, time-optimal under velocity, acceleration and jerk limits.

    Jerk is constant between points of the trajectory, whose times are whole nanoseconds, so that the quintic
    between points is the motion itself. Points are at least `shortest` apart, because closer ones would lose
    the jerk in the rounding of positions; this costs a fraction of a millisecond.

    A target pose is reached in the configuration that is nearest in time (`AnalyticalInverseKinematic`), or
    in the named one; for a robot without a closed form, in the one that `DampedLeastSquares` finds from the
    start. Continuous axes turn by at most half a turn.

    An instance keeps scratch memory: use one per thread.

    Args:
        robot: The robot.
        configuration: Configuration in which a target pose is reached; the nearest by default.
        options: See `TrajectoryGenerator`.

    Raises:
        InvalidInputError: an option that is not valid, or a configuration of a robot without a closed form.
    """

    kinds: ClassVar[tuple[str, ...]] = ('joint', 'joint_to_pose')
    starts_moving: ClassVar[bool] = True
    synchronization: Synchronization

    def __init__(
        self, robot: BaseRobotModel, *, configuration: Configuration | None = None, **options: Any
    ) -> None:
        super().__init__(robot, **options)
        self.configuration = configuration
        if configuration is not None and self._closed_form is None:
            raise InvalidInputError(
                f'configuration {configuration} needs a robot with a closed-form inverse kinematics, '
                f'{robot.name} has none; leave it out for the nearest solution'
            )
        axes = robot.axes_data
        self._limits = np.array([self.velocity, self.acceleration, self.jerk])
        self._full = np.array([axes.velocity, axes.acceleration, axes.jerk])
        fractions = self.speed_fraction, self.acceleration_fraction, self.acceleration_fraction
        self._allowed = np.array(fractions)[:, None] * self._full
        self._continuous = axes.continuous if axes.continuous.any() else None
        # Rounding of the positions at both ends enters the quintic's jerk times 60 / h^3.
        largest = np.where(axes.continuous, LARGEST_ANGLE, np.maximum(np.abs(axes.lower), np.abs(axes.upper)))
        shortest = np.cbrt(60.0 * 2.0 * np.spacing(largest) / (LIMIT_MARGIN * axes.jerk)).max()
        self.shortest = int(np.ceil(shortest / NANOSECOND / 1000.0)) * 1000
        """Length of the shortest piece of constant jerk, ns."""

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """See `TrajectoryGenerator.from_settings`."""
        configuration = known_configuration(settings.configuration)
        return super().from_settings(robot, settings, configuration=configuration, **options)

    def _plan(self, start: Array, target: Target) -> Trajectory:
        return self.plan_to_joints(start, self.goal(start, target))

    def generate_moving(self, motion: tuple[ArrayLike, ArrayLike, ArrayLike], target: Target) -> Trajectory:
        """See `TrajectoryGenerator.generate_moving`.

        Raises:
            PlanningError: an axis moves so fast at the start that it cannot stop before its limit; or as
                `generate`.
            InvalidInputError: wrong shapes, NaN or infinity, or a start that moves above a limit.
        """
        axes = self.robot.axes_data
        start = axes.check_position(motion[0], 'q_start')
        goal = self.goal(start, target)
        q_dot, q_ddot = (
            finite_vector(values, axes.num_axes, name)
            for values, name in zip(motion[1:], ('q_dot_start', 'q_ddot_start'), strict=True)
        )
        if not q_dot.any() and not q_ddot.any():
            return self.plan_to_joints(start, goal)
        check_start_motion(axes, start, q_dot, q_ddot)
        return self._from_motion(np.array([start, q_dot, q_ddot]), goal)

    def joint_path(self, start: Array, target: Target) -> JointPath:
        """See `TrajectoryGenerator.joint_path`."""
        goals = self._goals(start, target)
        if float(np.abs(goals[0] - start).max()) < SHORTEST_MOVE:
            raise PlanningError('a motion that goes nowhere has no path to run through')
        return self._path(start, goals)

    def _goals(self, start: Array, target: Target) -> Array:
        """Postures (k, n) that reach a target, the nearest first."""
        return self.goal(start, target)[None]

    def _path(self, start: Array, goals: Array) -> JointPath:
        """The path from a posture (n,) to the nearest of several others, (k, n)."""
        way, still = np.array([goals[0] - start] * 2), np.zeros((2, len(start)))
        return JointPath(np.array([0.0, 1.0]), np.array([start, goals[0]]), way, still)

    def goal(self, start: Array, target: Target) -> Array:
        """Joint positions (n,) in which a target is reached from `start`, which is inside the limits.

        Raises:
            JointLimitError: the target is outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the pose.
        """
        if isinstance(target, Pose):
            goal = self.reach(target, start)
        else:
            goal = self.robot.axes_data.check_position(cast('ArrayLike', target), 'target')
        if self._continuous is not None:
            displacement = np.remainder(goal - start + np.pi, TURN) - np.pi
            goal = np.where(self._continuous, start + displacement, goal)
        return goal

    def _from_motion(self, state: Array, goal: Array) -> Trajectory:
        """Plan from a moving state (3, n)."""
        axes, waypoint = self.robot.axes_data, goal
        first: NoProfileError | None = None
        # An axis that brakes just before its limit may have to reverse first, whatever its target is.
        for _ in range(axes.num_axes + 1):
            try:
                points = self._profile.plan(state, waypoint, self._limits, self._allowed, self._full)
            except NoProfileError as error:
                axis, first = error.axis, first or error
                if waypoint[axis] != goal[axis] or axes.continuous[axis]:
                    break
                waypoint = waypoint.copy()
                waypoint[axis] = axes.middle_and_half[0][axis]
                continue
            away = Trajectory(*points)
            return (
                away if waypoint is goal else one_after_another([away, self.plan_to_joints(waypoint, goal)])
            )
        assert first is not None
        raise self._no_motion(first.axis, state, goal)

    def _no_motion(self, axis: int, state: Array, goal: Array) -> PlanningError:
        axes = self.robot.axes_data
        name, unit = axes.names[axis], axes.unit(axis)
        q, q_dot, q_ddot = (float(row[axis]) for row in state)
        return PlanningError(
            f'no motion found from {name} at {q:.6g} {unit} with {q_dot:.6g} {unit}/s and {q_ddot:.6g} '
            f'{unit}/s^2 to {goal[axis]:.6g} {unit} inside its limits [{axes.lower[axis]:.6g}, '
            f'{axes.upper[axis]:.6g}] {unit}',
            joint=name,
            value=q,
        )

    def plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_pose`."""
        return self.plan_to_joints(start, self.reach(target, start))

    def plan_to_joints(self, start: Array, target: Array) -> Trajectory:
        """See `TrajectoryGenerator.plan_to_joints`."""
        distances = np.abs(target - start).tolist()
        if max(distances) < SHORTEST_MOVE:
            return rest_trajectory(start, target)
        least = max(map(truediv, distances, self.velocity.tolist()))
        if least > LONGEST_MOTION:
            raise InvalidInputError(
                f'the motion takes {least:.6g} s or more; allowed are {LONGEST_MOTION:g} s'
            )
        try:
            points = self._from_rest(start, target)
        except NoProfileError as error:
            still = np.zeros_like(start)
            raise self._no_motion(error.axis, np.array([start, still, still]), target) from None
        for values in points:
            values.setflags(write=False)  # new arrays, which the trajectory takes without a copy
        return Trajectory(*points)

    def _from_rest(self, start: Array, target: Array) -> tuple[Array, Array, Array, Array]:
        """Times (m,), positions, velocities and accelerations (m, n) from rest to rest at another place."""
        still = np.zeros_like(start)
        state = np.array([start, still, still])
        return self._profile.plan(state, target, self._limits, self._allowed, self._full)

    def reach(self, pose: Pose, q_start: Array) -> Array:
        """See `TrajectoryGenerator.reach`; in the configuration that is set, or that is nearest in time."""
        if self.hold != POSE:
            return super().reach(pose, q_start)
        if self.tool is not None:
            pose = pose @ self.tool.inverse()
        if self._closed_form is not None:
            try:
                return self._closed_form.solve(pose, q_start, configuration=self.configuration)
            except UnreachablePoseError:
                if self.configuration is not None:
                    raise
        # Its error names the distance to the closest reachable pose.
        return super().reach(pose, q_start)

    @cached_property
    def inverse_kinematics(self) -> DampedLeastSquares | HeldInverseKinematics:
        """Of tool0; where less than a pose is held, of the tool centre point. Made when first needed."""
        return DampedLeastSquares(self.robot) if self.hold == POSE else super().inverse_kinematics

    @cached_property
    def _closed_form(self) -> AnalyticalInverseKinematic | None:
        try:
            return AnalyticalInverseKinematic(self.robot)
        except NoAnalyticInverseKinematicsError:
            return None

    @cached_property
    def _profile(self) -> StateToRestProfile:
        axes = self.robot.axes_data
        reach = np.array([axes.lower, axes.upper])
        return StateToRestProfile(reach, self.synchronization, self.shortest)

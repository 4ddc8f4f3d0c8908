"""PathPlanning: switches between the trajectory generators by the kind of motion."""

from __future__ import annotations

import contextlib
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any, Final, cast

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.collision_detection import CollisionDetection, checked_margin
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, LINE, MotionKind
from robots_planning.motion_settings import IDENTITY, MotionSettings, known_configuration
from robots_planning.paths.path_deviation import SampledPath
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.cartesian_generator import Planner
from robots_planning.trajectory_generators.circular_cartesian import CircularCartesian
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator
from robots_planning.trajectory_generators.linear_cartesian_dynamic_programming import (
    LinearCartesianDynamicProgramming,
)
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited
from robots_planning.trajectory_generators.linear_joint import LinearJoint
from robots_planning.trajectory_generators.linear_joint_axes import LinearJointAxes
from robots_planning.trajectory_generators.poses_generator import PosesGenerator
from robots_planning.trajectory_generators.spline_cartesian import SplineCartesian
from robots_planning.verification import VerificationReport, verify

WARM_UP_STEP = 0.01  # rad, m
MOST_GENERATORS = 16  # kept for the settings that were used last
JOINT_GENERATORS: Final[dict[str, type[JointSpaceGenerator]]] = {
    'linear_joint': LinearJoint,
    'linear_joint_axes': LinearJointAxes,
}
CURVES: Final[dict[str, type[PosesGenerator]]] = {'circle': CircularCartesian, 'spline': SplineCartesian}

Target = Pose | ArrayLike | tuple[Pose, ...]
Generator = JointSpaceGenerator | LinearCartesianLimited | LinearCartesianDynamicProgramming | PosesGenerator


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A verified plan.

    Attributes:
        trajectory: What to do.
        kind: What was commanded; None for a trajectory that was given.
        report: What verification found; `report.ok` is true.
    """

    trajectory: Trajectory
    kind: MotionKind | None
    report: VerificationReport

    @property
    def duration(self) -> float:
        """Planned duration, s."""
        return self.trajectory.duration

    @property
    def limiting_axis(self) -> str:
        """The axis with the highest use of a velocity, acceleration or torque limit."""
        return self.report.limiting.joint


class PathPlanning:
    """The paper's path-planning component: the right generator for every kind of motion, then verification.

    Generators keep scratch memory: use an instance in one thread.

    Args:
        robot: The robot.
        collision: Who refuses motions that collide; None lets them pass.
        collision_margin: Distance that every motion keeps, m, from 0.

    Raises:
        InvalidInputError: a margin that is negative or not finite.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        collision: CollisionDetection | None = None,
        collision_margin: float = 0.0,
    ) -> None:
        self.robot = robot
        self._generators: OrderedDict[object, Generator] = OrderedDict()
        self.collision = collision
        self.collision_margin = checked_margin(collision_margin)

    def plan(
        self,
        kind: MotionKind,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings | None = None,
    ) -> PlannedMotion:
        """Plan and verify a motion from rest to rest.

        Args:
            kind: One of `MOTION_KINDS`.
            q_start: Joint positions to start from, (n,), rad (m).
            target: What the kind needs: joint positions (n,), a Pose of the tool in the frame `base` of the
                settings, or the poses of a curve: (via, end) or (via, second via, start) of a circle, all to
                pass of a spline.
            settings: Modal settings.

        Raises:
            JointLimitError: start or target outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the pose.
            PlanningError: the motion is impossible, or its plan breaks a limit; says where and why.
            CollisionError: the motion collides, or comes closer to something than the margin.
            InvalidInputError: a target of another kind than the motion's.
        """
        settings = settings or MotionSettings()
        trajectory = self.trajectory(kind, q_start, target, settings)
        line, path = None, None
        if kind.cartesian:
            generator, goal = self.generator(kind, settings), in_base(kind, target, settings)
            start = Pose(*self.robot.direct_kinematics(trajectory.position[0])) @ settings.tool_pose
            if isinstance(goal, Pose):
                line = (start, goal)
            elif isinstance(generator, PosesGenerator) and isinstance(goal, tuple):
                path = generator.path(start, goal)
        return self.checked(trajectory, kind, settings, line=line, path=path)

    def trajectory(
        self,
        kind: MotionKind,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings,
    ) -> Trajectory:
        """The plan alone, without verification; arguments as for `plan`.

        Raises:
            RobotsError: as `plan`.
        """
        generator = self.generator(kind, settings)
        goal = in_base(kind, target, settings)
        if isinstance(generator, PosesGenerator):
            return generator.generate(q_start, goal if isinstance(goal, tuple) else ())
        assert not isinstance(goal, tuple)
        return generator.generate(q_start, goal)

    def plan_moving(
        self,
        kind: MotionKind,
        motion: tuple[ArrayLike, ArrayLike, ArrayLike],
        target: Target,
        settings: MotionSettings,
    ) -> PlannedMotion:
        """Plan and verify a joint motion from a robot that moves, to rest.

        Args:
            kind: A joint motion.
            motion: Joint positions, velocities and accelerations to start from, (n,) each.
            target: Joint positions (n,) or a Pose, as for `plan`.
            settings: Modal settings.

        Raises:
            RobotsError: as `plan`.
        """
        generator = self.generator(kind, settings)
        goal = in_base(kind, target, settings)
        if not isinstance(generator, JointSpaceGenerator) or isinstance(goal, tuple):
            raise InvalidInputError(f'{kind.title} cannot start from a robot that moves')
        q, q_dot, q_ddot = motion
        trajectory = generator.generate(q, goal, q_dot_start=q_dot, q_ddot_start=q_ddot)
        return self.checked(trajectory, kind, settings, start_motion=(q_dot, q_ddot))

    def checked(
        self,
        trajectory: Trajectory,
        kind: MotionKind | None = None,
        settings: MotionSettings | None = None,
        *,
        line: tuple[Pose, Pose] | None = None,
        path: SampledPath | None = None,
        start_motion: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> PlannedMotion:
        """A trajectory that has passed verification and the check for collisions; arguments as for `verify`.

        Raises:
            PlanningError: it breaks a limit.
            CollisionError: it collides, or comes closer to something than the margin.
        """
        # The other generators do not plan with torque limits, and say so.
        settings = settings or MotionSettings()
        torque = settings.cartesian_planner == 'dynamic_programming' and kind is not None and kind.cartesian
        report = verify(
            trajectory,
            self.robot,
            line=line,
            path=path,
            tool=settings.tool_pose,
            torque=torque,
            start_motion=start_motion,
        )
        if not report.ok:
            what = f'the plan of {kind.title}' if kind is not None else 'the trajectory'
            raise PlanningError(f'{what} breaks a limit: {report.describe()}')
        self.check_collisions(trajectory)
        return PlannedMotion(trajectory, kind, report)

    def check_collisions(self, trajectory: Trajectory) -> None:
        """Pass a trajectory on which nothing comes closer than the margin.

        Raises:
            CollisionError: something does; names the bodies and the first place on the path.
        """
        if self.collision is not None:
            path = JointPath(
                trajectory.time, trajectory.position, trajectory.velocity, trajectory.acceleration
            )
            self.collision.check(path, margin=self.collision_margin)

    def warm_up(self) -> None:
        """Plan a tiny motion of every kind, so that the first real one finds all code loaded."""
        home = self.robot.home
        axes = self.robot.axes_data
        near = home + np.where(home + WARM_UP_STEP < axes.upper, WARM_UP_STEP, -WARM_UP_STEP)
        pose = Pose(*self.robot.direct_kinematics(near))
        for kind, target in ((JOINT, near), (JOINT_TO_POSE, pose), (LINE, pose)):
            # A home may be singular, and then has no line; its code is loaded all the same.
            with contextlib.suppress(RobotsError):
                self.plan(kind, home, target)

    def generator(self, kind: MotionKind, settings: MotionSettings) -> Generator:
        """The trajectory generator for a kind of motion; made once for the same settings.

        Raises:
            InvalidInputError: settings that the robot or the planner cannot keep.
        """
        key = (kind, settings)
        if key not in self._generators:
            self._generators[key] = self._make(kind, settings)
            if len(self._generators) > MOST_GENERATORS:
                self._generators.popitem(last=False)
        self._generators.move_to_end(key)
        return self._generators[key]

    def _make(self, kind: MotionKind, settings: MotionSettings) -> Generator:
        tool = None if settings.tool == IDENTITY else settings.tool_pose
        if not kind.cartesian:
            wanted = settings.configuration if kind is JOINT_TO_POSE else ''
            return JOINT_GENERATORS[settings.joint_planner](
                self.robot,
                speed_fraction=settings.speed_fraction,
                acceleration_fraction=settings.acceleration_fraction,
                tool=tool,
                configuration=known_configuration(wanted),
            )
        options: dict[str, Any] = {
            name: getattr(settings, name)
            for name in (
                'speed_fraction',
                'acceleration_fraction',
                'cartesian_speed',
                'cartesian_acceleration',
                'rotation_speed',
                'rotation_acceleration',
                'jerk_limited',
            )
        }
        options['tool'] = tool
        if kind.planner:
            return CURVES[kind.name](
                self.robot, **options, planner=cast('Planner', settings.cartesian_planner)
            )
        if settings.cartesian_planner == 'dynamic_programming':
            return LinearCartesianDynamicProgramming(self.robot, **options)
        return LinearCartesianLimited(self.robot, **options)


def in_base(kind: MotionKind, target: Target, settings: MotionSettings) -> Target:
    """A target in the robot's base frame.

    Raises:
        InvalidInputError: a target of another kind than the motion's.
    """
    match target:
        case Pose() if kind.target == 'pose':
            return settings.in_base(target)
        case tuple() | list() if kind.target == 'poses' and all(isinstance(pose, Pose) for pose in target):
            return tuple(settings.in_base(pose) for pose in target if isinstance(pose, Pose))
        case _ if kind.target == 'joints' and not isinstance(target, Pose):
            return target
    needed = {'joints': 'joint positions', 'pose': 'a Pose', 'poses': 'poses'}[kind.target]
    raise InvalidInputError(f'{kind.title} needs {needed} as target, got {type(target).__name__}')

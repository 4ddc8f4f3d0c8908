"""PathPlanning: switches between the trajectory generators by the robot's command state."""

from __future__ import annotations

import contextlib
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, cast

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.collision_detection import CollisionDetection, checked_margin
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.motion_settings import IDENTITY, MotionSettings, known_configuration
from robots_planning.paths.path_deviation import SampledPath
from robots_planning.robot_command_state import JOINT_STATES, RobotCommandState, Shape
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
        kind: The command state that asked for it.
        report: What verification found; `report.ok` is true.
    """

    trajectory: Trajectory
    kind: RobotCommandState
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
    """The paper's path-planning component: the right generator for every command state, then verification.

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
        state: RobotCommandState,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings | None = None,
        *,
        shape: Shape = 'line',
    ) -> PlannedMotion:
        """Plan and verify a motion from rest to rest.

        Args:
            state: PTPJOINT_JOINT, PTPJOINT_CARTESIAN or PTPCARTESIAN.
            q_start: Joint positions to start from, (n,), rad (m).
            target: Joint positions (n,) for PTPJOINT_JOINT; else a Pose of the tool in the frame `base` of
                the settings, or the poses of a curve: (via, end) or (via, second via, start) of a circle,
                all to pass of a spline.
            settings: Modal settings.
            shape: Of the tool's path in PTPCARTESIAN.

        Raises:
            JointLimitError: start or target outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the pose.
            PlanningError: the motion is impossible, or its plan breaks a limit; says where and why.
            CollisionError: the motion collides, or comes closer to something than the margin.
            InvalidInputError: a state that plans nothing, or a target of another kind than the state's.
        """
        settings = settings or MotionSettings()
        trajectory = self.trajectory(state, q_start, target, settings, shape)
        line, path = None, None
        if state is RobotCommandState.PTPCARTESIAN:
            generator, goal = self.generator(state, settings, shape), in_base(state, shape, target, settings)
            start = Pose(*self.robot.direct_kinematics(trajectory.position[0])) @ settings.tool_pose
            if isinstance(goal, Pose):
                line = (start, goal)
            elif isinstance(generator, PosesGenerator) and isinstance(goal, tuple):
                path = generator.path(start, goal)
        return self.checked(trajectory, state, settings, line=line, path=path)

    def trajectory(
        self,
        state: RobotCommandState,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings,
        shape: Shape = 'line',
    ) -> Trajectory:
        """The plan alone, without verification; arguments as for `plan`.

        Raises:
            RobotsError: as `plan`.
        """
        generator = self.generator(state, settings, shape)
        goal = in_base(state, shape, target, settings)
        if isinstance(generator, PosesGenerator):
            return generator.generate(q_start, goal if isinstance(goal, tuple) else ())
        assert not isinstance(goal, tuple)
        return generator.generate(q_start, goal)

    def plan_moving(
        self,
        state: RobotCommandState,
        motion: tuple[ArrayLike, ArrayLike, ArrayLike],
        target: Target,
        settings: MotionSettings,
    ) -> PlannedMotion:
        """Plan and verify a joint motion from a robot that moves, to rest.

        Args:
            state: PTPJOINT_JOINT or PTPJOINT_CARTESIAN.
            motion: Joint positions, velocities and accelerations to start from, (n,) each.
            target: Joint positions (n,) or a Pose, as for `plan`.
            settings: Modal settings.

        Raises:
            RobotsError: as `plan`.
        """
        generator = self.generator(state, settings)
        goal = in_base(state, 'line', target, settings)
        if not isinstance(generator, JointSpaceGenerator) or isinstance(goal, tuple):
            raise InvalidInputError(f'{state} cannot start from a robot that moves')
        q, q_dot, q_ddot = motion
        trajectory = generator.generate(q, goal, q_dot_start=q_dot, q_ddot_start=q_ddot)
        return self.checked(trajectory, state, settings, start_motion=(q_dot, q_ddot))

    def checked(
        self,
        trajectory: Trajectory,
        state: RobotCommandState,
        settings: MotionSettings,
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
        torque = settings.cartesian_planner == 'dynamic_programming' and state not in JOINT_STATES
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
            raise PlanningError(f'the plan of {state} breaks a limit: {report.describe()}')
        self.check_collisions(trajectory)
        return PlannedMotion(trajectory, state, report)

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
        for state, target in (
            (RobotCommandState.PTPJOINT_JOINT, near),
            (RobotCommandState.PTPJOINT_CARTESIAN, pose),
            (RobotCommandState.PTPCARTESIAN, pose),
        ):
            # A home may be singular, and then has no line; its code is loaded all the same.
            with contextlib.suppress(RobotsError):
                self.plan(state, home, target)

    def generator(
        self, state: RobotCommandState, settings: MotionSettings, shape: Shape = 'line'
    ) -> Generator:
        """The trajectory generator for a command state; made once for the same settings.

        Raises:
            InvalidInputError: a state that plans nothing, or settings that the robot or the planner cannot
                keep.
        """
        key = (state, shape, settings)
        if key not in self._generators:
            self._generators[key] = self._make(state, settings, shape)
            if len(self._generators) > MOST_GENERATORS:
                self._generators.popitem(last=False)
        self._generators.move_to_end(key)
        return self._generators[key]

    def _make(self, state: RobotCommandState, settings: MotionSettings, shape: Shape) -> Generator:
        tool = None if settings.tool == IDENTITY else settings.tool_pose
        if state in JOINT_STATES:
            wanted = settings.configuration if state is RobotCommandState.PTPJOINT_CARTESIAN else ''
            return JOINT_GENERATORS[settings.joint_planner](
                self.robot,
                speed_fraction=settings.speed_fraction,
                acceleration_fraction=settings.acceleration_fraction,
                tool=tool,
                configuration=known_configuration(wanted),
            )
        if state is not RobotCommandState.PTPCARTESIAN:
            raise InvalidInputError(
                f'{state} is not planned ahead; planned are PTPJOINT_JOINT, PTPJOINT_CARTESIAN and '
                'PTPCARTESIAN'
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
        if shape != 'line':
            return CURVES[shape](self.robot, **options, planner=cast('Planner', settings.cartesian_planner))
        if settings.cartesian_planner == 'dynamic_programming':
            return LinearCartesianDynamicProgramming(self.robot, **options)
        return LinearCartesianLimited(self.robot, **options)


def in_base(
    state: RobotCommandState, shape: Shape, target: Target, settings: MotionSettings
) -> Pose | ArrayLike | tuple[Pose, ...]:
    """A target in the robot's base frame.

    Raises:
        InvalidInputError: a target of another kind than the motion's.
    """
    curve = state is RobotCommandState.PTPCARTESIAN and shape != 'line'
    if curve and isinstance(target, Sequence) and all(isinstance(pose, Pose) for pose in target):
        return tuple(settings.in_base(pose) for pose in target if isinstance(pose, Pose))
    if curve:
        raise InvalidInputError(f'a {shape} needs poses as target, got {type(target).__name__}')
    if isinstance(target, Pose) == (state is RobotCommandState.PTPJOINT_JOINT):
        expected = 'joint positions' if state is RobotCommandState.PTPJOINT_JOINT else 'a Pose'
        raise InvalidInputError(f'{state} needs {expected} as target, got {type(target).__name__}')
    return settings.in_base(target) if isinstance(target, Pose) else target

"""PathPlanning: switches between the trajectory generators by the robot's command state."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import positive
from robots_planning.robot_command_state import RobotCommandState
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import TrajectoryGenerator, usable_fraction
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited
from robots_planning.trajectory_generators.linear_joint import LinearJoint
from robots_planning.verification import VerificationReport, verify

WARM_UP_STEP = 0.01  # rad, m


@dataclass(frozen=True)
class MotionSettings:
    """Modal settings: they hold for every motion until they are changed.

    Attributes:
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration and jerk limits to use, in (0, 1].
        cartesian_speed: Highest speed of the tool on Cartesian motions, m/s.
        cartesian_acceleration: Highest acceleration of the tool along its path, m/s^2.
        rotation_speed: Highest angular speed of the tool, rad/s.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2.

    Raises:
        InvalidInputError: a fraction outside (0, 1], or another setting that is not above 0.
    """

    speed_fraction: float = 1.0
    acceleration_fraction: float = 1.0
    cartesian_speed: float = 0.5
    cartesian_acceleration: float = 2.0
    rotation_speed: float = 1.5
    rotation_acceleration: float = 6.0

    def __post_init__(self) -> None:
        usable_fraction(self.speed_fraction, 'speed_fraction')
        usable_fraction(self.acceleration_fraction, 'acceleration_fraction')
        positive(self.cartesian_speed, 'cartesian_speed', 'm/s')
        positive(self.cartesian_acceleration, 'cartesian_acceleration', 'm/s^2')
        positive(self.rotation_speed, 'rotation_speed', 'rad/s')
        positive(self.rotation_acceleration, 'rotation_acceleration', 'rad/s^2')


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
        """The axis with the highest use of a velocity or acceleration limit."""
        return self.report.limiting.joint


class PathPlanning:
    """The paper's path-planning component: the right generator for every command state, then verification.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot

    def plan(
        self,
        state: RobotCommandState,
        q_start: ArrayLike,
        target: Pose | ArrayLike,
        settings: MotionSettings | None = None,
    ) -> PlannedMotion:
        """Plan and verify a motion from rest to rest.

        Args:
            state: PTPJOINT_JOINT, PTPJOINT_CARTESIAN or PTPCARTESIAN.
            q_start: Joint positions to start from, (n,), rad (m).
            target: Joint positions (n,) for PTPJOINT_JOINT, else a Pose of tool0 in the base frame.
            settings: Modal settings.

        Raises:
            JointLimitError: start or target outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the pose.
            PlanningError: the motion is impossible, or its plan breaks a limit; says where and why.
            InvalidInputError: a state that plans nothing, or a target of another kind than the state's.
        """
        generator = self.generator(state, settings or MotionSettings())
        if isinstance(target, Pose) == (state is RobotCommandState.PTPJOINT_JOINT):
            expected = 'joint positions' if state is RobotCommandState.PTPJOINT_JOINT else 'a Pose'
            raise InvalidInputError(f'{state} needs {expected} as target, got {type(target).__name__}')
        trajectory = generator.generate(q_start, target)
        line = None
        if state is RobotCommandState.PTPCARTESIAN:
            assert isinstance(target, Pose)
            line = (Pose(*self._robot.direct_kinematics(trajectory.position[0])), target)
        # Torque is not among the limits that these generators plan with.
        report = verify(trajectory, self._robot, line=line, torque=False)
        if not report.ok:
            raise PlanningError(f'the plan of {state} breaks a limit: {report.describe()}')
        return PlannedMotion(trajectory, state, report)

    def warm_up(self) -> None:
        """Plan a tiny motion of every kind, so that the first real one finds all code loaded."""
        home = self._robot.home
        axes = self._robot.axes_data
        near = home + np.where(home + WARM_UP_STEP < axes.upper, WARM_UP_STEP, -WARM_UP_STEP)
        pose = Pose(*self._robot.direct_kinematics(near))
        for state, target in (
            (RobotCommandState.PTPJOINT_JOINT, near),
            (RobotCommandState.PTPJOINT_CARTESIAN, pose),
            (RobotCommandState.PTPCARTESIAN, pose),
        ):
            # A home may be singular, and then has no line; its code is loaded all the same.
            with contextlib.suppress(RobotsError):
                self.plan(state, home, target)

    def generator(self, state: RobotCommandState, settings: MotionSettings) -> TrajectoryGenerator:
        """The trajectory generator for a command state.

        Raises:
            InvalidInputError: a state that plans nothing.
        """
        if state in (RobotCommandState.PTPJOINT_JOINT, RobotCommandState.PTPJOINT_CARTESIAN):
            return LinearJoint(
                self._robot,
                speed_fraction=settings.speed_fraction,
                acceleration_fraction=settings.acceleration_fraction,
            )
        if state is RobotCommandState.PTPCARTESIAN:
            return LinearCartesianLimited(
                self._robot,
                speed_fraction=settings.speed_fraction,
                acceleration_fraction=settings.acceleration_fraction,
                cartesian_speed=settings.cartesian_speed,
                cartesian_acceleration=settings.cartesian_acceleration,
                rotation_speed=settings.rotation_speed,
                rotation_acceleration=settings.rotation_acceleration,
            )
        raise InvalidInputError(
            f'{state} is not planned ahead; planned are PTPJOINT_JOINT, PTPJOINT_CARTESIAN and PTPCARTESIAN'
        )

"""LinearCartesianDynamicProgramming: a straight line of the tool in the shortest time."""

from __future__ import annotations

from functools import cached_property
from typing import ClassVar

import numpy as np

from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.base import LIMIT_MARGIN, TrajectoryGenerator, rest_trajectory
from robots_planning.trajectory_generators.cartesian_line import CartesianLine
from robots_planning.trajectory_generators.cartesian_path import COINCIDENT_ANGLE, COINCIDENT_DISTANCE
from robots_planning.trajectory_generators.joint_path import JointPath
from robots_planning.trajectory_generators.path_inverse_kinematics import PathInverseKinematics
from robots_planning.trajectory_generators.posture_graph import PostureGraph, Route
from robots_planning.trajectory_generators.time_optimal import TimeOptimalTiming, ToolLimits


class LinearCartesianDynamicProgramming(TrajectoryGenerator):
    """The tool moves on a straight line and turns about one axis, in the shortest time.

    Velocity, acceleration and torque limits of the axes hold everywhere. The speed along the line is found by
    dynamic programming over path and speed (Shin and McKay 1986; Pham and Pham 2018); acceleration may jump,
    which short ramps make continuous. Close to a singularity the motion slows down; in one, the tool may
    stand still while the axes turn to a posture from which the line goes on. Robots with more than six axes
    use their self-motion (see `PostureGraph`).

    Args:
        robot: The robot.
        speed_fraction: Part of the axes' velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the axes' acceleration limits to use, in (0, 1].
        torque: Keep the axes' torque limits too.
        cartesian_speed: Highest speed of the tool, m/s; none by default.
        cartesian_acceleration: Highest acceleration of the tool along the line, m/s^2; none by default.
        rotation_speed: Highest angular speed of the tool, rad/s; none by default.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2; none by default.
        jerk_limited: Keep the axes' jerk limits too, by smoothing the time law; no longer the shortest time.
        tool: Pose of the tool centre point in tool0; poses commanded are its poses. tool0 itself by default.

    Raises:
        InvalidInputError: a fraction outside (0, 1], or another option that is not above 0.
    """

    accepts_joints: ClassVar[bool] = False

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        speed_fraction: float = 1.0,
        acceleration_fraction: float = 1.0,
        torque: bool = True,
        cartesian_speed: float | None = None,
        cartesian_acceleration: float | None = None,
        rotation_speed: float | None = None,
        rotation_acceleration: float | None = None,
        jerk_limited: bool = False,
        tool: Pose | None = None,
    ) -> None:
        super().__init__(robot, speed_fraction=speed_fraction, acceleration_fraction=acceleration_fraction)
        self._tool_velocity = np.array(
            [
                _limit(cartesian_speed, 'cartesian_speed', 'm/s'),
                _limit(rotation_speed, 'rotation_speed', 'rad/s'),
            ]
        )
        self._tool_acceleration = np.array(
            [
                _limit(cartesian_acceleration, 'cartesian_acceleration', 'm/s^2'),
                _limit(rotation_acceleration, 'rotation_acceleration', 'rad/s^2'),
            ]
        )
        self.tool = tool
        self._kinematics = PathInverseKinematics(robot, tool)
        self._postures = PostureGraph(robot, self._kinematics, tool)
        effort = robot.axes_data.effort * (1.0 - LIMIT_MARGIN) if torque else None
        self._timing = TimeOptimalTiming(
            robot, self.velocity, self.acceleration, effort, jerk=self.jerk if jerk_limited else None
        )

    @cached_property
    def inverse_kinematics(self) -> DampedLeastSquares:
        """Of the tool centre point; made when it is first needed."""
        return DampedLeastSquares(self.robot, tool=self.tool)

    def _plan_to_pose(self, start: Array, target: Pose) -> Trajectory:
        line = CartesianLine(self._kinematics.pose(start), target)
        if line.length < COINCIDENT_DISTANCE and line.angle < COINCIDENT_ANGLE:
            return rest_trajectory(start, start)
        return self._fastest(line, start)[0]

    def follow(self, line: CartesianLine, start: Array) -> JointPath | None:
        """The joint path of a line that begins at joint positions `start`, (n,), as a motion would take it.

        Returns:
            The path; None where the tool stands still in a singularity on the way.

        Raises:
            PlanningError: the line is impossible; says where and why.
            UnreachablePoseError: its end cannot be reached at all.
        """
        route = self._fastest(line, start)[1]
        return route[0].joints if len(route) == 1 else None

    def _fastest(self, line: CartesianLine, start: Array) -> tuple[Trajectory, Route]:
        plans = [(self._timed(route), route) for route in self._routes(line, start)]
        return min(plans, key=lambda plan: plan[0].duration)

    def _routes(self, line: CartesianLine, start: Array) -> list[Route]:
        # A pose that no posture reaches is told as such, before the place where the line fails.
        try:
            return self._postures.routes(line, start)
        except PlanningError:
            self.reach(line.end, start)
            raise

    def _timed(self, route: Route) -> Trajectory:
        return one_after_another(
            [self._timing.trajectory(piece.joints, self._tool_limits(piece.line)) for piece in route]
        )

    def _tool_limits(self, line: CartesianLine | None) -> ToolLimits | None:
        limits = np.concatenate([self._tool_velocity, self._tool_acceleration])
        if line is None or np.isinf(limits).all():
            return None
        travel = np.array([line.length, line.angle])

        def derivatives(s: Array) -> tuple[Array, Array]:
            return np.broadcast_to(travel, (len(s), 2)), np.zeros((len(s), 2))

        return ToolLimits(derivatives, self._tool_velocity, self._tool_acceleration)


def _limit(value: float | None, name: str, unit: str) -> float:
    return np.inf if value is None else positive(value, name, unit)


def one_after_another(trajectories: list[Trajectory]) -> Trajectory:
    """Motions from rest to rest, each beginning where the one before ends, as one."""
    first = trajectories[0]
    time, rows = [first.time], [(first.position, first.velocity, first.acceleration)]
    for following in trajectories[1:]:
        time.append(Trajectory.message_times(time[-1][-1] + following.time[1:]))
        rows.append((following.position[1:], following.velocity[1:], following.acceleration[1:]))
    if len(rows) == 1:
        return first
    return Trajectory(np.concatenate(time), *(np.concatenate(parts) for parts in zip(*rows, strict=True)))

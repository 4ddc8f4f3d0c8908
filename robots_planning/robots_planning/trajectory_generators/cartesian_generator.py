"""CartesianGenerator: motions along a path of the tool, inside the limits of axes and tool."""

from abc import abstractmethod
from typing import Any, Final, Self

import numpy as np

from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.errors import PlanningError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive
from robots_planning.motion_settings import MotionSettings
from robots_planning.path_kinematics.configuration_graph import ConfigurationGraph
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.path_kinematics.route import Route, RoutePiece
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import TimeOptimalTiming
from robots_planning.timing.tool_limits import path_limits
from robots_planning.trajectory import Trajectory, one_after_another
from robots_planning.trajectory_generators.trajectory_generator import (
    LIMIT_MARGIN,
    Target,
    ToolGeometry,
    TrajectoryGenerator,
    rest_trajectory,
)

TOOL_LIMITS: Final = ('cartesian_speed', 'cartesian_acceleration', 'rotation_speed', 'rotation_acceleration')
"""Settings of Cartesian motions, which are arguments of these planners, as `jerk_limited` is."""

# Of acceleration without limits of torque and jerk: part of the duration, which it lengthens, and at most.
SMOOTHING_SHARE: Final = 0.005
LONGEST_SMOOTHING: Final = 0.008  # s
STILL: Final = 1e-9  # rad (m)


class CartesianGenerator(TrajectoryGenerator):
    """The tool centre point follows a path of poses, as fast as the limits of axes and tool allow.

    The path is timed by `TimeOptimalTiming`. By default axis torque is not limited, and the acceleration is
    smoothed. Near a singularity the motion becomes slow. An arm that holds less than a pose turns the tool as
    it must.

    Args:
        robot: The robot.
        cartesian_speed: Highest speed of the tool, m/s; as for the other limits of the tool, None for none.
        cartesian_acceleration: Highest acceleration of the tool, m/s^2; on a curve its magnitude, with the
            centripetal part.
        rotation_speed: Highest angular speed of the tool, rad/s.
        rotation_acceleration: Highest angular acceleration of the tool, rad/s^2.
        jerk_limited: Keep the axes' jerk limits too.
        keeps_torque: Keep the limits of the axes' torque too, and choose among configurations (see
            `ConfigurationGraph`); as its class by default.
        options: See `TrajectoryGenerator`.

    Raises:
        InvalidInputError: an option that is not valid.
    """

    configuration_graph: ConfigurationGraph | None = None

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        cartesian_speed: float | None = 0.5,
        cartesian_acceleration: float | None = 2.0,
        rotation_speed: float | None = 1.5,
        rotation_acceleration: float | None = 6.0,
        jerk_limited: bool = False,
        keeps_torque: bool | None = None,
        **options: Any,
    ) -> None:
        super().__init__(robot, **options)
        self.path_kinematics = PathInverseKinematics(robot, self.tool, hold=self.hold)
        motion = (
            ('cartesian_speed', cartesian_speed, 'm/s'),
            ('cartesian_acceleration', cartesian_acceleration, 'm/s^2'),
            ('rotation_speed', rotation_speed, 'rad/s'),
            ('rotation_acceleration', rotation_acceleration, 'rad/s^2'),
        )
        self._tool_limits = np.array(
            [np.inf if value is None else positive(value, name, unit) for name, value, unit in motion]
        )
        if keeps_torque is not None:
            self.keeps_torque = keeps_torque
        if self.hold == POSE and self.keeps_torque:
            self.configuration_graph = ConfigurationGraph(self.path_kinematics)
        smoothed = {'ramp': SMOOTHING_SHARE, 'longest_ramp': LONGEST_SMOOTHING}
        self._timing = TimeOptimalTiming(
            robot,
            self.velocity,
            self.acceleration,
            robot.axes_data.effort * (1.0 - LIMIT_MARGIN) if self.keeps_torque else None,
            jerk=self.jerk if jerk_limited else None,
            **{} if self.keeps_torque else smoothed,
        )

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """See `TrajectoryGenerator.from_settings`."""
        limits = {name: getattr(settings, name) for name in (*TOOL_LIMITS, 'jerk_limited')}
        return super().from_settings(robot, settings, **limits, **options)

    @abstractmethod
    def path(self, start: Pose, target: Any) -> CartesianPath:
        """The path of the tool from pose `start` to a target.

        Raises:
            InvalidInputError: the target determines no path; says why.
        """

    def joint_path(self, start: Array, target: Target) -> JointPath | None:
        """See `TrajectoryGenerator.joint_path`."""
        return self.follow(self.path(self.path_kinematics.pose(start), target), start)

    def geometry(self, start: Pose, target: Target) -> ToolGeometry:
        """See `TrajectoryGenerator.geometry`."""
        return {'path': self.path(start, target), 'oriented': self.hold == POSE}

    def plan_path(self, path: CartesianPath, start: Array) -> Trajectory:
        """The motion along a path that begins at joint positions `start`, (n,).

        Raises:
            PlanningError: the path leaves the axis limits or the reach, or crosses a singularity; says where.
            UnreachablePoseError: the end of the path cannot be reached at all.
        """
        routes = self._routes(path, start)
        if stands_still(routes[0]):
            return rest_trajectory(start, start)
        return self._fastest(routes, path)[0]

    def follow(self, path: CartesianPath, start: Array) -> JointPath | None:
        """The joint path that `plan_path` would take along a path; raises as `plan_path`.

        Returns:
            The joint path; None if the tool stands still in a singularity on it, or the axes stand still.
        """
        routes = self._routes(path, start)
        if stands_still(routes[0]):
            return None
        route = routes[0] if len(routes) == 1 else self._fastest(routes, path)[1]
        return route[0].joints if len(route) == 1 else None

    def _routes(self, path: CartesianPath, start: Array) -> list[Route]:
        # An unreachable end of the path is reported as such, rather than where following fails.
        try:
            if self.configuration_graph is not None:
                return self.configuration_graph.routes(path, start)
            return [(RoutePiece(self.path_kinematics.follow(path, start), 0.0, 1.0),)]
        except PlanningError:
            self.reach(path.end, start)
            raise

    def _fastest(self, routes: list[Route], path: CartesianPath) -> tuple[Trajectory, Route]:
        """The route that takes least time; others are left out once they are sure to take longer."""
        if len(routes) == 1:
            pieces = [self.along(piece.joints, piece.tool(path)) for piece in routes[0]]
            return one_after_another(pieces), routes[0]
        best: tuple[Trajectory, Route] | None = None
        longest = np.inf
        timed: dict[RoutePiece, Trajectory] = {}
        for route in sorted(routes, key=lambda route: sum(map(self._least_time, route))):
            trajectory = self._timed(route, path, timed, longest)
            if trajectory is not None and trajectory.duration < longest:
                best, longest = (trajectory, route), trajectory.duration
        assert best is not None
        return best

    def _least_time(self, piece: RoutePiece) -> float:
        """Lower bound on the duration, s: the axes' displacements, from rest to rest."""
        distance = np.abs(np.diff(piece.joints.q, axis=0)).sum(axis=0)
        ramp = self.velocity**2 / self.acceleration  # distance of accelerating to full speed and stopping
        fast = (distance + ramp) / self.velocity
        slow = 2.0 * np.sqrt(distance / self.acceleration)
        return float(np.where(distance > ramp, fast, slow).max())

    def _timed(
        self, route: Route, path: CartesianPath, timed: dict[RoutePiece, Trajectory], longest: float
    ) -> Trajectory | None:
        """The trajectory of a route; None if it is sure to take longer than `longest`, s.

        Pieces that `timed` holds from another route are not timed again.
        """
        times = {
            piece: timed[piece].duration if piece in timed else self._least_time(piece) for piece in route
        }
        # For turns with the tool at rest the lower bound is tight, so they are timed last.
        for piece in sorted(route, key=lambda piece: piece.begin == piece.end):
            if sum(times.values()) > longest:
                return None
            if piece not in timed:
                timed[piece] = self.along(piece.joints, piece.tool(path))
                times[piece] = timed[piece].duration
        return one_after_another([timed[piece] for piece in route])

    def along(self, joint_path: JointPath, tool_path: CartesianPath) -> Trajectory:
        """The timed motion from rest to rest along both over the same s; see `TimeOptimalTiming.timed`."""
        turning_tool = None
        if self.hold != POSE:
            turning_tool = np.zeros(3) if self.tool is None else self.tool.r
        limits = path_limits(self.robot, joint_path, tool_path, self._tool_limits, turning_tool)
        return self._timing.timed(joint_path, limits).trajectory


def stands_still(route: Route) -> bool:
    """An arm that holds less than a pose may have nothing to do for a path that only turns."""
    return all(float(np.ptp(piece.joints.q, axis=0).max()) < STILL for piece in route)

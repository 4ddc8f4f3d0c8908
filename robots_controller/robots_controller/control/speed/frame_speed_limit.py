"""FrameSpeedLimit: a cap on the speed of the tool and of the frames of all axes, on every motion."""

from __future__ import annotations

from typing import Final

import numpy as np

from robots_controller.control.controller_settings import checked_speed_limit
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.timing.path_speed_cap import PathSpeedCap, path_times
from robots_planning.trajectory import Trajectory

PATH_MARGIN: Final = 0.98  # the speed may rise by the rest between two places
STEP: Final = 1e-6  # rad, m: of an axis, for differences of places
REFRESH: Final = 10  # periods for which a stream's share of the axes' speeds holds
STREAM_MARGIN: Final = 0.95  # the speeds of the frames may rise by the rest meanwhile


class FrameSpeedLimit:
    """How fast the tool, the flange and the frames of the axes may move.

    Motions keep it by a lower speed on their path, streams by lower speeds of all axes.

    Args:
        robot: The robot.
        limit: m/s; 0 for none.

    Raises:
        InvalidInputError: a limit below 0 or not finite.
    """

    def __init__(self, robot: BaseRobotModel, limit: float = 0.0) -> None:
        self._robot = robot
        self._tools = np.zeros((1, 3))
        self._share, self._share_holds = 1.0, 0
        self.limit = limit

    @property
    def limit(self) -> float:
        """m/s; 0 for none."""
        return self._limit

    @limit.setter
    def limit(self, limit: float) -> None:
        self._limit = checked_speed_limit(limit)
        self._share_holds = 0

    def set_tool(self, position: Array) -> None:
        """Position of the tool centre point in tool0, (3,) m; the one before counts on."""
        if not np.array_equal(position, self._tools[-1]):
            self._tools = np.array([self._tools[-1], position])
            self._share_holds = 0

    def cap(self, trajectory: Trajectory, acceleration: Array, ramp_time: float) -> PathSpeedCap | None:
        """How fast the path of a trajectory may be followed; None without a limit.

        Args:
            trajectory: The trajectory.
            acceleration: Limits of the axes, (n,), rad/s^2.
            ramp_time: Shortest time in which the path speed falls from 1 to 0, s.
        """
        if self._limit == 0.0:
            return None
        times = path_times(trajectory)
        count = times.size - 1
        places = np.array([self._places(row) for row in trajectory.sample_position(times)])
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=2) * (count / trajectory.duration)
        # Speeds are means of intervals. One that changes evenly except for one instant differs from its mean
        # by at most half of the difference between this interval and one of its neighbours.
        around = np.abs(np.diff(np.pad(speeds, ((1, 1), (0, 0)), mode='edge'), axis=0))
        fastest = (speeds + 0.5 * np.maximum(around[:-1], around[1:])).max(axis=1)
        limit = PATH_MARGIN * self._limit
        allowed = limit / np.maximum(fastest, limit)
        return PathSpeedCap.of(trajectory, acceleration, ramp_time, allowed)

    def stream_share(self, q: Array) -> float:
        """The share of the axes' velocity limits, 0..1, at which no frame is too fast, whatever axes move.

        At joint positions `q`, (n,), rad (m).
        """
        if self._limit == 0.0:
            return 1.0
        if self._share_holds == 0:
            here, speeds = self._places(q), np.zeros(0)
            for axis, velocity in enumerate(self._robot.axes_data.velocity):
                moved = q.copy()
                moved[axis] += STEP
                axis_speeds = np.linalg.norm(self._places(moved) - here, axis=1) * (velocity / STEP)
                speeds = axis_speeds if axis == 0 else speeds + axis_speeds
            self._share = min(1.0, STREAM_MARGIN * self._limit / max(speeds.max(), self._limit))
            self._share_holds = REFRESH
        self._share_holds -= 1
        return self._share

    def _places(self, q: Array) -> Array:
        frames, _ = self._robot.kinematic_model.frame_axes(q)
        r, T = self._robot.direct_kinematics(q)
        return np.vstack([frames, r, r + self._tools @ T.T])

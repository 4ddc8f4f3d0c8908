"""MotionAdmission: which of the motions that come from another process the controller follows."""

import math
from dataclasses import dataclass, replace
from typing import Final

from robots_core.errors import InvalidInputError, NotNowError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_planning.trajectory import Trajectory
from robots_planning.verification.trajectory_verification import verify

GIVEN_UP_AFTER: Final = 0.5  # s, until the planner has noticed that a commander is lost, or that it was


@dataclass(frozen=True)
class Loss:
    """A node that was lost, and which motions are refused for that.

    Attributes:
        reason: For a person.
        until: So long they are refused, s; by default none is.
        before: Those that were commanded before this, ns of ROS time; by default all.
    """

    reason: str = ''
    until: float = -math.inf
    before: float = math.inf


class MotionAdmission:
    """Admits motions that keep the robot's limits, and that nobody has given up.

    Times are in s on the controller's clock, stamps in ns of ROS time.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot
        self._commander_loss = self._planner_loss = Loss()

    def lose_commander(self, reason: str, now: float) -> None:
        """Refuse motions for now: the planner may send one that the lost commander has commanded."""
        self._commander_loss = Loss(reason, until=now + GIVEN_UP_AFTER)

    def lose_planner(self, reason: str, stamp: int) -> None:
        """Refuse what was commanded before the planner was lost."""
        self._planner_loss = Loss(reason, math.inf, stamp)

    def planner_is_back(self, now: float) -> None:
        """Refuse it for some time more: the planner may be about to send it."""
        self._planner_loss = replace(self._planner_loss, until=now + GIVEN_UP_AFTER)

    def check_lost(self, now: float, commanded: int) -> None:
        """Check that a motion, commanded at this stamp, has not been given up.

        Raises:
            NotNowError: it has.
        """
        for loss in (self._commander_loss, self._planner_loss):
            if now < loss.until and commanded < loss.before:
                raise NotNowError(f'given up: {loss.reason}')

    def check_limits(self, trajectory: Trajectory, *, joins: bool) -> None:
        """Check a trajectory, which begins at rest unless it joins the motion before it.

        Raises:
            InvalidInputError: it breaks a limit.
        """
        moving = (trajectory.velocity[0], trajectory.acceleration[0]) if joins else None
        report = verify(trajectory, self._robot, torque=False, start_motion=moving)
        if not report.ok:
            raise InvalidInputError(f'joint_trajectory breaks a limit: {report.describe()}')

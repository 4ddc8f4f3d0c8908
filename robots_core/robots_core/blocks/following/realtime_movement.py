"""RealtimeMovement: sensor-guided motion along a stream of reference poses, checked for feasibility."""

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.following.following_methods import METHODS
from robots_core.blocks.following.pose_following import FollowedStep, pose_following
from robots_core.blocks.following.pose_reference import PoseReference, moved
from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import UnreachablePoseError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, positive, read_only

# A reference that is further away is not feasible; the angle counts where whole poses are followed.
TOLERANCES: Final = (1e-3, 5e-3)  # m, rad
# Largest lead of the integrated pose over the robot while servoing.
LARGEST_LEAD: Final = (0.01, 0.02)  # m, rad


class MovementState(StrEnum):
    """What the movement does."""

    IDLE = 'IDLE'
    """No reference came yet, or the robot stands since the last one went stale."""
    FOLLOWING = 'FOLLOWING'
    STALE = 'STALE'
    """No fresh reference: the robot brakes to a stop."""


@dataclass(frozen=True, eq=False)
class RealtimeStep:
    """Motion of one period.

    Attributes:
        q: Joint positions at its end, (n,), rad (m), read-only.
        q_dot: Joint velocities at its end, (n,), rad/s.
        q_ddot: Joint accelerations during it, (n,), rad/s^2.
        state: What the movement does.
        feasible: The reference is followed inside the tolerances, and no limit had to be broken.
        position_error: Distance to the reference at its end, m.
        orientation_error: Angle to the reference at its end, rad.
        slack: By how much a limit had to be broken, relative to it.
        limits: Why a reference cannot be followed: limits as 'A2 velocity upper', or what the method says.
        error: The method finds no solution for the reference: the robot brakes.
    """

    q: Array
    q_dot: Array
    q_ddot: Array
    state: MovementState
    feasible: bool = True
    position_error: float = 0.0
    orientation_error: float = 0.0
    slack: float = 0.0
    limits: tuple[str, ...] = ()
    error: UnreachablePoseError | None = None

    @property
    def reason(self) -> str:
        """Why the reference is not feasible, in a line; empty if it is."""
        if self.feasible:
            return ''
        return (
            f'the reference is {self.position_error * 1e3:.3g} mm and {self.orientation_error:.3g} rad away'
            + (f', a limit is passed by {100.0 * self.slack:.3g} %' if self.slack > 0.0 else '')
            + (f'; limited by {", ".join(self.limits)}' if self.limits else '')
        )


class RealtimeMovement:
    """Follows a reference that comes at any rate, by one of the inverse kinematics.

    Poses are extrapolated between samples and a little beyond (`PoseReference`); a twist beside them is their
    velocity. Without poses it leads the tool on from where it is (servoing). All limits are kept
    (`PoseFollowing`), and the robot can be braked at any time. Without a fresh sample it is.

    An instance keeps scratch memory and the state of the motion: use one per thread.

    Args:
        robot: The robot.
        dt: Period, s.
        q: Where it stands, (n,), rad (m).
        tool: Pose of the tool centre point in tool0, which follows the reference.
        method: 'constrained' (all limits, torques too), 'damped_least_squares' or 'analytical'.
        hold: What of the reference is followed, see `held_by`; what the arm can by default.
        timeout: Without a sample for this long the reference is stale, s.

    Raises:
        InvalidInputError: an option out of its range.
        JointLimitError: `q` is outside the limits.
        NoAnalyticInverseKinematicsError: 'analytical' of a robot without a closed form.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        dt: float,
        q: ArrayLike,
        *,
        tool: Pose | None = None,
        method: str = METHODS[0],
        hold: str = '',
        timeout: float = 0.2,
    ) -> None:
        self.robot, self.timeout = robot, timeout
        self.dt = positive(dt, 'dt', 's')
        self._make_following = partial(
            pose_following, method, dt=dt, tool=Pose.identity() if tool is None else tool, hold=hold
        )
        self._following = self._make_following(robot)
        self._reference = PoseReference(timeout=timeout)
        self.place(q)

    def place(self, q: ArrayLike, q_dot: ArrayLike | None = None) -> None:
        """Start again from a state of the robot, (n,) each, rad (m) and rad/s; at rest by default.

        A velocity above its limit counts as the limit.
        """
        axes = self.robot.axes_data
        start = np.clip(axes.check_position(q, 'q'), axes.lower, axes.upper)
        still = np.zeros_like(start)
        moving = still
        if q_dot is not None:
            moving = np.clip(finite_vector(q_dot, axes.num_axes, 'q_dot'), -axes.velocity, axes.velocity)
        self._state = np.array([start, moving, still])
        self._begin = start
        self._following.begin(start)
        self._movement = MovementState.STALE if moving.any() else MovementState.IDLE
        self._integrated: Pose | None = None

    def load(self, payload: Payload) -> None:
        """Carry a payload from the next step on, in all torques; also while another thread calls `step`.

        Raises:
            InvalidInputError: see `LoadedRobot`.
        """
        robot = LoadedRobot(self.robot, payload) if payload.mass > 0.0 else self.robot
        following = self._make_following(robot)
        following.begin(self._begin)
        self._following = following

    def put(self, pose: Pose, time: float) -> None:
        """Take a reference pose of the tool in the base frame that was valid at a time, s."""
        self._reference.put(pose, time)

    def put_twist(self, twist: ArrayLike, time: float) -> None:
        """Take how the reference moves, (6,): m/s, rad/s, base frame.

        Poses without it are differentiated; without poses the tool follows it from where it is (servoing).

        Raises:
            InvalidInputError: not six numbers up to `FASTEST`.
        """
        self._reference.put_twist(twist, time)

    def release(self) -> None:
        """Forget the reference: the robot brakes to a stop, until another one comes."""
        self._reference = PoseReference(timeout=self.timeout)
        self._integrated = None

    def fresh(self, now: float) -> bool:
        """A sample came within the timeout; now in s."""
        return self._reference.fresh_pose(now) or self._reference.fresh_twist(now)

    def step(self, now: float) -> RealtimeStep:
        """Motion of the next period; now in s, on the clock of the poses."""
        q, q_dot = self._state[0], self._state[1]
        if not self.fresh(now):
            return self._brake()
        self._movement = MovementState.FOLLOWING
        target, twist = self._target(now, q)
        try:
            step = self._following.follow(target, twist, q, q_dot)
        except UnreachablePoseError as error:
            braked = self._following.brake(q, q_dot)
            errors = self._following.pose(braked[0]).distance_to(target)
            step = FollowedStep(braked, *errors, limits=(error.message,))
            return replace(self._result(step, feasible=False), error=error)
        if not self._within(LARGEST_LEAD, step):
            self._integrated = None
        return self._result(step, feasible=self._within(TOLERANCES, step) and step.slack <= 0.0)

    def _within(self, bounds: tuple[float, float], step: FollowedStep) -> bool:
        """The errors are at most these, m and rad."""
        turns_freely = self._following.hold != POSE
        return step.position_error <= bounds[0] and (turns_freely or step.orientation_error <= bounds[1])

    def _target(self, now: float, q: Array) -> tuple[Pose, Array]:
        """Pose of the tool at the end of the period, and its twist (6,)."""
        if self._reference.fresh_pose(now):
            self._integrated = None
            return self._reference.at(now + self.dt, now)
        twist = self._reference.twist(now)
        self._integrated = moved(self._integrated or self._following.pose(q), twist, self.dt)
        return self._integrated, twist

    def _brake(self) -> RealtimeStep:
        moving = bool(self._state[1].any())
        self._movement = MovementState.STALE if moving else MovementState.IDLE
        step = FollowedStep(self._following.brake(self._state[0], self._state[1]), 0.0, 0.0)
        return self._result(step, feasible=True)

    def _result(self, step: FollowedStep, *, feasible: bool) -> RealtimeStep:
        self._state = np.array(step.state)
        q, q_dot, q_ddot = (read_only(row) for row in step.state)
        return RealtimeStep(
            q,
            q_dot,
            q_ddot,
            self._movement,
            feasible,
            step.position_error,
            step.orientation_error,
            step.slack,
            step.limits,
        )

"""TeachBox: slow jogging of the axes or of the tool, as with the hand-held box of a robot."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.following.axis_following import AxisFollowing
from robots_core.blocks.following.pose_reference import FASTEST, moved
from robots_core.blocks.inverse_kinematics.constrained import ConstrainedInverseKinematics
from robots_core.blocks.inverse_kinematics.hold import POSE, POSITION, held_by, weights_of
from robots_core.blocks.inverse_kinematics.viability import velocity_interval
from robots_core.pose import Pose
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.wrapped_robot import WrappedRobot
from robots_core.validation import Array, bounded_vector, finite_vector, one_of, positive, read_only
from robots_planning.guidance.jog_axes import JOG_AXES, JogAxes
from robots_planning.trajectory_generators.trajectory_generator import usable_fraction

# Of the tool's speed limits: the rest is for how a Jacobian changes in a period, and for returning.
SPEED_RESERVE = 0.1
# How fast the tool returns to where it should be, 1/s, and how far behind it may be: the further, the slower
# it is led on, so that limits make it slow and do not lead it astray.
RETURN_GAIN = 5.0
LEASH = (0.002, 0.01)  # m, rad
ROTATION_SPEED = 0.5  # rad/s, of a jogged tool
RAMP_TIME = 0.25  # s, in which a jogged tool gains its highest speed
# Of the axes' accelerations, for changes of the tool's speed; the rest is for returning to its line. Where
# they allow less than the least part of a change, near singularities, the tool leaves its line sooner than it
# never ends.
FOLLOWED, LEAST_FOLLOWED = 0.9, 0.2
OUT_OF_REACH = 'out of reach'  # of a tool: no axis is at a limit, but the arm is stretched or singular
STANDSTILL = 1e-12  # rad/s (m/s)
JOG_RATE = 125.0  # Hz, of a robot that follows a teach box
# Behind a jogged robot the reference is by what smoothing and a few late periods make; farther away, the
# controller does not follow, and going on would make it jump when it does.
JOG_DEVIATION = 0.05  # rad (m)
SHARES = (1.0, 0.7, 0.4, 0.2, 0.0)  # of a wanted velocity, until the tool is slow enough
NO_TWIST = np.zeros(6)


@dataclass(frozen=True, eq=False)
class TeachStep:
    """Motion of one period.

    Attributes:
        q: Joint positions at its end, (n,), rad (m), read-only.
        q_dot: Joint velocities at its end, (n,), rad/s.
        q_ddot: Joint accelerations during it, (n,), rad/s^2.
        jogging: A fresh command is followed; otherwise the robot brakes, or stands.
        limits: What stops or slows it, as 'A2 position upper' or OUT_OF_REACH; empty if nothing does.
    """

    q: Array
    q_dot: Array
    q_ddot: Array
    jogging: bool
    limits: tuple[str, ...] = ()

    @property
    def standing(self) -> bool:
        """No axis moves."""
        return not self.q_dot.any()


class SlowedRobot(WrappedRobot):
    """The same robot with parts of its velocity and acceleration limits, for blocks that use all they have.

    Args:
        robot: The robot.
        speed_fraction: Part of the velocity limits, in (0, 1].
        acceleration_fraction: Part of the acceleration and jerk limits, in (0, 1].

    Raises:
        InvalidInputError: a fraction outside (0, 1].
    """

    def __init__(self, robot: BaseRobotModel, *, speed_fraction: float, acceleration_fraction: float) -> None:
        super().__init__(robot)
        speed = usable_fraction(speed_fraction, 'speed_fraction')
        acceleration = usable_fraction(acceleration_fraction, 'acceleration_fraction')
        axes = robot.axes_data
        self._axes_data = replace(
            axes,
            velocity=speed * axes.velocity,
            acceleration=acceleration * axes.acceleration,
            jerk=acceleration * axes.jerk,
        )

    @property
    def axes_data(self) -> AxesData:
        """The lowered limits."""
        return self._axes_data


class TeachBox:
    """Follows jog commands inside reduced limits; stops when they end or a limit comes.

    A command is a velocity that holds until the next one, and no longer than the timeout (dead-man): without
    a fresh command the axes brake to a stop, a tool along its line. Axes are jogged each on its own, the tool
    along and about axes of the base, the tool or the world by `ConstrainedInverseKinematics`. At a position
    limit the axis stops, and with it a tool that cannot continue; the step names the limit. State and limits
    are always such that braking ends before the position limits (see `viability`).

    An instance keeps scratch memory and the state of the motion: use one per thread.

    Args:
        robot: The robot.
        dt: Period, s.
        q: Where it stands, (n,), rad (m).
        speed_fraction: Part of the velocity limits to use, in (0, 1].
        acceleration_fraction: Part of the acceleration limits to use, in (0, 1].
        tool_speed: Highest speed of the tool centre point, m/s; by default that of manual reduced speed in
            ISO 10218-1.
        rotation_speed: Highest angular speed of a jogged tool, rad/s.
        tool: Pose of the tool centre point in tool0.
        world: Pose of the robot's base in the world.
        hold: What a jogged tool holds, see `held_by`; what the arm can by default.
        timeout: Age of a command at which the robot stops, s.

    Raises:
        InvalidInputError: an option out of its range.
        JointLimitError: `q` is outside the limits.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        dt: float,
        q: ArrayLike,
        *,
        speed_fraction: float = 0.1,
        acceleration_fraction: float = 0.3,
        tool_speed: float = 0.25,
        rotation_speed: float = ROTATION_SPEED,
        tool: Pose | None = None,
        world: Pose | None = None,
        hold: str = '',
        timeout: float = 0.1,
    ) -> None:
        self.hold = held_by(robot.num_axes, hold)
        self.robot = SlowedRobot(
            robot, speed_fraction=speed_fraction, acceleration_fraction=acceleration_fraction
        )
        self.dt = positive(dt, 'dt', 's')
        self.timeout = positive(timeout, 'timeout', 's')
        self.tool = Pose.identity() if tool is None else tool
        self.world = Pose.identity() if world is None else world
        self._speeds = np.array(
            [positive(tool_speed, 'tool_speed', 'm/s'), positive(rotation_speed, 'rotation_speed', 'rad/s')]
        )
        axes = self.robot.axes_data
        self._ik = ConstrainedInverseKinematics(
            self.robot, dt, tool=self.tool, gain=min(RETURN_GAIN, 1.0 / dt), weights=weights_of(self.hold)
        )
        braking = self._ik.deceleration
        self._axes = AxisFollowing(axes, dt, deceleration=braking)
        self._limits = np.array([axes.lower, axes.upper, axes.velocity, axes.acceleration, braking])
        self._low, self._high = np.empty(axes.num_axes), np.empty(axes.num_axes)
        self._command: Array = np.zeros(axes.num_axes)
        self._frame: JogAxes | None = None
        self._time = -np.inf
        self._twist: Array = NO_TWIST  # the ramp to the command
        self._led: Array = NO_TWIST  # the twist that the tool was led with
        self._pose: Pose | None = None
        self._behind = 0.0
        self.place(q)

    @property
    def q(self) -> Array:
        """Joint positions now, (n,)."""
        return np.array(self._state[0])

    def place(self, q: ArrayLike) -> None:
        """Start again from where the robot stands, (n,), rad (m); a command that was given is forgotten."""
        axes = self.robot.axes_data
        # The limits' own tolerance is no room to move in.
        start = np.clip(axes.check_position(q, 'q'), axes.lower, axes.upper)
        self._state = np.array([start, np.zeros_like(start), np.zeros_like(start)])
        self._time = -np.inf
        self._lead_from_here()

    def jog_axes(self, velocity: ArrayLike, time: float) -> None:
        """Take a command for the axes, given at a time, s.

        Args:
            velocity: (n,), rad/s (m/s); what is above the reduced limits is lowered to them.
            time: On the same clock as `step`.

        Raises:
            InvalidInputError: another shape, NaN or infinity.
        """
        self._command = np.array(finite_vector(velocity, self.robot.num_axes, 'velocity'))
        self._frame, self._time = None, time

    def jog_tool(self, twist: ArrayLike, time: float, frame: JogAxes = 'base') -> None:
        """Take a command for the tool, given at a time, s.

        Args:
            twist: (6,): velocity (m/s), angular velocity (rad/s) of the tool centre point; what is above the
                reduced speeds is lowered to them in its direction.
            time: On the same clock as `step`.
            frame: Along and about the axes of 'base', 'base_link', 'tool' or 'world'.

        Raises:
            InvalidInputError: not six numbers up to `FASTEST`, or no such axes.
        """
        values = bounded_vector(twist, 6, 'twist', FASTEST, 'm/s, rad/s')
        one_of('frame', JOG_AXES)(frame)
        self._command, self._frame, self._time = np.array(values), frame, time

    def step(self, now: float) -> TeachStep:
        """Motion of the next period.

        Args:
            now: s.
        """
        fresh = 0.0 <= now - self._time <= self.timeout
        if self._frame is not None and ((fresh and self._command.any()) or self._twist.any()):
            return self._step_tool(self._frame, released=not fresh)
        self._lead_from_here()
        if fresh and self._frame is None:
            return self._step_axes()
        self._state = self._axes.brake(self._state[0], self._state[1])
        return self._result(jogging=fresh)

    def _lead_from_here(self) -> None:
        """The next jog of the tool starts at rest from where the tool is then."""
        self._twist, self._led, self._pose, self._behind = NO_TWIST, NO_TWIST, None, 0.0

    def _step_axes(self) -> TeachStep:
        axes, dt = self.robot.axes_data, self.dt
        q, q_dot = self._state[0], self._state[1]
        velocity_interval(q, q_dot, self._limits, dt, self._low, self._high)
        wanted = np.clip(self._command, -axes.velocity, axes.velocity)
        change = axes.acceleration * dt
        # Reasons not to continue as fast, or not even to start.
        blocked = ((wanted > 0.0) & (self._high < np.minimum(wanted, q_dot + change))) | (
            (wanted < 0.0) & (self._low > np.maximum(wanted, q_dot - change))
        )
        limits = tuple(
            f'{axes.names[i]} position {"upper" if wanted[i] > 0.0 else "lower"}'
            for i in np.flatnonzero(blocked)
        )
        wanted = np.where(blocked, np.clip(wanted, self._low, self._high), wanted)
        end = q_dot
        for share in SHARES:
            # All axes change by the same part: between two velocities that are slow enough are no others.
            missing = share * wanted - q_dot
            part = float(np.min(change / np.maximum(np.abs(missing), change)))
            end = np.clip(q_dot + part * missing, self._low, self._high)
            if self._tool_speed(q + 0.5 * dt * (q_dot + end), end) <= (1.0 - SPEED_RESERVE) * self._speeds[0]:
                break
        # At a limit speeds only halve from step to step; an axis that no position shows moving stands.
        end = np.where(np.abs(end) < STANDSTILL, 0.0, end)
        # It stops at the limit except for rounding.
        there = np.clip(q + 0.5 * dt * (q_dot + end), axes.lower, axes.upper)
        self._state = np.array([there, end, (end - q_dot) / dt])
        return self._result(jogging=True, limits=limits)

    def _step_tool(self, frame: JogAxes, *, released: bool) -> TeachStep:
        q, q_dot, dt = self._state[0], self._state[1], self.dt
        here = self._tool_pose(q)
        if released:  # from how it was led, which limits have slowed
            wanted, self._twist = NO_TWIST, self._led
        else:
            wanted = self._wanted_twist(frame, here)
        ramp = np.repeat(self._speeds * dt / RAMP_TIME, 3)
        change = wanted - self._twist
        change *= float(np.min(ramp / np.maximum(np.abs(change), ramp)))
        self._twist = self._twist + self._followed_part(here, change) * change
        # A tool that stops is not slowed down by its distance from where it is led: it may be ahead.
        self._led = self._twist if released else max(0.0, 1.0 - self._behind) * self._twist
        pose = moved(self._pose or here, self._led, dt)
        step = self._ik.step(pose, q, q_dot, self._led)
        self._behind = step.position_error / LEASH[0]
        if self.hold == POSE:
            self._behind = max(self._behind, step.orientation_error / LEASH[1])
        else:  # it turns as the arm must, and is led on from there
            pose = Pose(pose.r, self._tool_pose(step.q).T)
        self._pose = pose
        limits = tuple(f'{item.joint} {item.quantity} {item.side}' for item in step.active_limits)
        if not limits and self._behind > 0.9:
            limits = (OUT_OF_REACH,)
        state = np.array(step.values[:3])
        astray = released and self._behind > 1.0
        if astray or self._tool_speed(state[0], state[1]) > self._speeds[0]:
            state, self._pose, self._behind = self._axes.brake(q, q_dot), None, 0.0
        self._state = state
        return self._result(jogging=not released, limits=limits)

    def _followed_part(self, here: Pose, change: Array) -> float:
        """The part of a change of the tool's twist that the axes can follow within a period."""
        q, q_dot, dt = self._state[0], self._state[1], self.dt
        J = np.array(self.robot.jacobian(q + dt * q_dot))
        J[:3] += np.cross(J[3:], here.T @ self.tool.T.T @ self.tool.r, axisa=0, axisc=0)
        rows = slice(None, 3 if self.hold == POSITION else 6)
        J, change = J[rows], change[rows]
        missing = self._led[rows] - J @ q_dot
        (going_on, further), room = (
            np.linalg.lstsq(J, np.column_stack([missing, change]), rcond=None)[0].T,
            FOLLOWED * self.robot.axes_data.acceleration * dt,
        )
        with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
            parts = np.where(further > 0.0, room - going_on, room + going_on) / np.abs(further)
        return float(np.clip(np.nanmin(parts), LEAST_FOLLOWED, 1.0))

    def _wanted_twist(self, frame: JogAxes, here: Pose) -> Array:
        """The commanded twist in the base frame, inside the speeds."""
        turn = {
            'base': np.eye(3),
            'base_link': self.robot.base_link.T,
            'tool': here.T,
            'world': self.world.T.T,
        }[frame]
        parts = self._command.reshape(2, 3) @ turn.T
        norms = np.linalg.norm(parts, axis=1)
        highest = (1.0 - SPEED_RESERVE) * self._speeds
        twist: Array = (parts * float(np.min(highest / np.maximum(norms, highest)))).ravel()
        return twist

    def _tool_pose(self, q: Array) -> Pose:
        pose: Pose = self.robot.pose(q) @ self.tool
        return pose

    def _tool_speed(self, q: Array, q_dot: Array) -> float:
        twist = self.robot.jacobian(q) @ q_dot
        lever = self.robot.direct_kinematics(q)[1] @ self.tool.r
        return float(np.linalg.norm(twist[:3] + np.cross(twist[3:], lever)))

    def _result(self, *, jogging: bool, limits: tuple[str, ...] = ()) -> TeachStep:
        q, q_dot, q_ddot = (read_only(row) for row in self._state)
        return TeachStep(q, q_dot, q_ddot, jogging, limits)

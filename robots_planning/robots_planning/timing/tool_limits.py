"""Limits of the tool along a path, and of all along a blended path whose motions have different limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from robots_core.kernels.compiled import compiled
from robots_core.kernels.serial_chain import ChainArrays, SerialChain, next_frame
from robots_core.kernels.vectors import add, cross, row_of, scale, subtract, times
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_settings import MotionSettings
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.cartesian_path_kernel import travel
from robots_planning.paths.joint_path import JointPath
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN

AT_CORNER = 1e-9  # of s: rounding of a place on a corner


@dataclass(frozen=True, eq=False)
class LimitedRates:
    """How k limited quantities, such as the length that the tool has travelled, change at m places of a path.

    Attributes:
        rate: First derivatives over s, (m, k): m or rad.
        along: Second derivatives, (m, k).
        across: What bends of the path add at right angles, per s_dot^2, (m, k), from 0.
        velocity: Limits, (k,) or (m, k), m/s or rad/s.
        acceleration: Limits of the acceleration, m/s^2 or rad/s^2.
        combined: They are limits of its length, with both parts; otherwise of each part.
    """

    rate: Array
    along: Array
    across: Array
    velocity: Array
    acceleration: Array
    combined: bool = True

    def over(self, s_1: Array, s_2: Array) -> LimitedRates:
        """The same over another coordinate, from both derivatives of s with respect to it, (m,) each."""
        first, square, second = s_1[:, None], (s_1**2)[:, None], s_2[:, None]
        along, across = self.along * square + self.rate * second, self.across * square
        return replace(self, rate=self.rate * first, along=along, across=across)

    def rows(self) -> Array:
        """The limits of acceleration as in `fastest_speeds`, (m, j, 4)."""
        m, k = self.rate.shape
        across = self.across / self.acceleration
        bent = np.flatnonzero(across.any(axis=0))
        rows = np.zeros((m, k if self.combined else k + len(bent), 4))
        rows[:, :k, 0], rows[:, :k, 1] = self.rate / self.acceleration, self.along / self.acceleration
        if self.combined:
            rows[:, :k, 3] = across
        else:
            rows[:, k:, 1] = across[:, bent]
        return rows

    def use(self, s_dot: Array, s_ddot: Array) -> Array:
        """The largest use of a limit at the speeds and accelerations s_dot and s_ddot, (m,)."""
        square = (s_dot**2)[:, None]
        along, across = self.along * square + self.rate * s_ddot[:, None], self.across * square
        acceleration = (np.hypot if self.combined else np.maximum)(np.abs(along), across)
        speed = np.abs(self.rate) * s_dot[:, None]
        return np.asarray(np.maximum(speed / self.velocity, acceleration / self.acceleration).max(axis=1))


@dataclass(frozen=True, eq=False)
class PathLimits:
    """Limits along a path.

    Attributes:
        at: Limits at values of s, (m,).
        jumps: Values of s at which they change at once, (j,), increasing; there those of both sides hold.
    """

    at: Callable[[Array], LimitedRates]
    jumps: Array = field(default_factory=lambda: np.empty(0))


def path_limits(
    robot: BaseRobotModel,
    joint_path: JointPath,
    tool_path: CartesianPath,
    tool: Array,
    turning_tool: Array | None,
) -> PathLimits | None:
    """Limits of the tool along a path; None where it has none.

    Args:
        robot: The robot.
        joint_path: Joint positions over s.
        tool_path: Poses of the tool over the same s.
        tool: Highest speed (m/s), acceleration, angular speed (rad/s) and angular acceleration of the tool,
            (4,); infinite for none.
        turning_tool: Position in tool0, (3,) m, of a tool that turns as the arm must, whose speeds are those
            of the axes' path; None for a tool that has the orientations of its own path.
    """
    if np.isinf(tool).all():
        return None
    chain = SerialChain.of(robot).arrays

    def limits(s: Array) -> LimitedRates:
        if turning_tool is None:
            rates = tool_path.travel(s)
        else:
            tools = np.tile(turning_tool, (len(s), 1))
            rates = travel(*tool_derivatives(chain, tools, *joint_path.evaluate(s)))
        return LimitedRates(*rates, tool[::2], tool[1::2])

    return PathLimits(limits)


def chain_limits(
    robot: BaseRobotModel,
    path: JointPath,
    corners: Array,
    sections: Sequence[tuple[MotionSettings, bool]],
) -> PathLimits:
    """Limits of axes and tool along a chain's path.

    Args:
        robot: The robot.
        path: The blended path.
        corners: Values of s at which one motion ends and the next begins, (k - 1,) for k sections.
        sections: The settings of each motion, and whether the limits of the tool hold in it.
    """
    axes, n, inside = robot.axes_data, robot.num_axes, 1.0 - LIMIT_MARGIN
    bounds = np.full((len(sections), 2, n + 2), np.inf)
    for bound, (setting, limited) in zip(bounds, sections, strict=True):
        bound[0, :n] = setting.speed_fraction * inside * axes.velocity
        bound[1, :n] = setting.acceleration_fraction * inside * axes.acceleration
        if limited:
            bound[0, n:] = setting.cartesian_speed, setting.rotation_speed
            bound[1, n:] = setting.cartesian_acceleration, setting.rotation_acceleration
    tools = np.array([setting.tool_pose.r for setting, _ in sections])
    chain = SerialChain.of(robot).arrays
    other_tools = (tools[1:] != tools[:-1]).any(axis=1)
    jumps = corners[other_tools | (bounds[1:] != bounds[:-1]).any(axis=(1, 2))]

    def limits(s: Array) -> LimitedRates:
        q, q_s, q_ss = path.evaluate(s)
        before, after = (
            np.searchsorted(corners, s + shift, side='right') for shift in (-AT_CORNER, AT_CORNER)
        )
        both = np.minimum(bounds[before], bounds[after])
        # Of two tools each has the limits of its own motion.
        of_tools = [(tools[after], both[:, :, n:])]
        if other_tools.any():
            of_tools = [(tools[section], bounds[section, :, n:]) for section in (before, after)]
        rates = [
            (q_s, q_ss, np.zeros_like(q)),
            *(travel(*tool_derivatives(chain, places, q, q_s, q_ss)) for places, _ in of_tools),
        ]
        rate, along, across = map(np.hstack, zip(*rates, strict=True))
        bound = np.concatenate([both[:, :, :n], *(own for _, own in of_tools)], axis=2)
        velocity, acceleration = bound.swapaxes(0, 1)
        return LimitedRates(rate, along, across, velocity, acceleration, combined=False)

    return PathLimits(limits, jumps)


@compiled()
def tool_derivatives(
    chain: ChainArrays, tools: Array, q: Array, q_s: Array, q_ss: Array
) -> tuple[Array, Array]:
    """First and second derivative of the tool's pose over s, (m, 6) each: linear, angular; base frame.

    They are velocity and acceleration of the tool for the joint velocities q_s and accelerations q_ss.

    Args:
        chain: The axes, and tool0.
        tools: The tool centre point in tool0 at each s, (m, 3).
        q: Joint positions, (m, n).
        q_s: First derivative, (m, n).
        q_ss: Second derivative, (m, n).
    """
    m, n = q.shape
    first, second = np.empty((m, 6)), np.empty((m, 6))
    for row in range(m):
        R, t = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0)
        # Of the point `last` of the link before: velocity and acceleration.
        last = v = a = omega = alpha = (0.0, 0.0, 0.0)
        for i in range(n):
            place, R, t = next_frame(chain, i, q[row, i], R, t)
            arm = subtract(place, last)
            swing = cross(omega, arm)
            v, a, last = add(v, swing), add(a, add(cross(alpha, arm), cross(omega, swing))), place
            axis = (R[0][2], R[1][2], R[2][2])
            rate, change = scale(q_s[row, i], axis), scale(q_ss[row, i], axis)
            if chain[i, 12] != 0.0:
                v, a = add(v, rate), add(a, add(change, scale(2.0, cross(omega, rate))))
            else:
                omega, alpha = add(omega, rate), add(alpha, add(change, cross(omega, rate)))
        tip, T, _ = next_frame(chain, n, 0.0, R, t)
        arm = subtract(add(tip, times(T, row_of(tools, row))), last)
        swing = cross(omega, arm)
        v, a = add(v, swing), add(a, add(cross(alpha, arm), cross(omega, swing)))
        for k in range(3):
            first[row, k], first[row, 3 + k] = v[k], omega[k]
            second[row, k], second[row, 3 + k] = a[k], alpha[k]
    return first, second

"""LimitUse: how much of a limit a trajectory uses; `AxisExtremes` axis by axis, `tool_speeds` of tools."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

TOOL_PERIOD = 4e-3  # s, the controller's


@dataclass(frozen=True)
class LimitUse:
    """The worst use of one kind of limit.

    Attributes:
        quantity: 'position', 'velocity', 'acceleration', 'jerk', 'torque', or 'speed' or 'angular speed' of
            a tool.
        ratio: Value over limit; for position 1 at a bound, 0 in the middle of the range.
        joint: Where; 'the tool' for the speeds of a tool.
        time: When, s.
        value: SI.
        limit: The bound, SI.
        unit: Of both.
    """

    quantity: str
    ratio: float
    joint: str
    time: float
    value: float
    limit: float
    unit: str

    def describe(self) -> str:
        """One line for a person."""
        return (
            f'{self.joint} {self.quantity} {self.value:.6g} {self.unit} at {self.time:.3f} s passes its '
            f'limit {self.limit:.6g} {self.unit} ({100.0 * self.ratio:.2f} %)'
        )


class AxisExtremes(NamedTuple):
    """The largest use of a limit on each axis.

    Attributes:
        ratio: Value over limit, (n,); for position 1 at a bound, 0 in the middle of the range.
        value: (n,), SI.
        limit: (n,), SI.
        time: When, (n,) s.
    """

    ratio: Array
    value: Array
    limit: Array
    time: Array

    @classmethod
    def of(cls, limit: Array, *parts: tuple[Array, Array]) -> Self:
        """Of samples in parts.

        Args:
            limit: (n,).
            parts: Each times, (k,) or (k, n), s, and values, (k, n); at least the first has some.
        """
        value, time = _largest(*parts)
        return cls(value / limit, value, limit, time)

    @classmethod
    def of_positions(cls, axes: AxesData, *parts: tuple[Array, Array]) -> Self:
        """Of positions, whose limits are the ends of each axis's range; parts as for `of`."""
        highest, when_highest = _largest(*parts)
        lowest, when_lowest = _largest(*((t, -q) for t, q in parts))
        middle, half = axes.middle_and_half
        above, below = (highest - middle) / half, (middle + lowest) / half
        high = above >= below
        return cls(
            np.where(high, above, below),
            np.where(high, highest, -lowest),
            np.where(high, axes.upper, axes.lower),
            np.where(high, when_highest, when_lowest),
        )

    def worst(self, quantity: str, axes: AxesData) -> LimitUse:
        """The use of the limit on the axis that uses most of it."""
        axis = int(self.ratio.argmax())
        return LimitUse(
            quantity=quantity,
            ratio=float(self.ratio[axis]),
            joint=axes.names[axis],
            time=float(self.time[axis]),
            value=float(self.value[axis]),
            limit=float(self.limit[axis]),
            unit=axes.unit(axis, quantity),
        )


def _largest(*parts: tuple[Array, Array]) -> tuple[Array, Array]:
    """The largest value of each axis and its time, (n,) each."""
    columns = np.arange(parts[0][1].shape[1])
    found = []
    for t, values in parts:
        if len(values):
            rows = values.argmax(axis=0)  # takes an eighth of the time of max(axis=0)
            found.append((values[rows, columns], t[rows] if t.ndim == 1 else t[rows, columns]))
    value, time = found[0]
    for other, when in found[1:]:
        value, time = np.where(other > value, other, value), np.where(other > value, when, time)
    return value, time


@dataclass(frozen=True, eq=False)
class ToolSection:
    """Limits of a tool centre point on a part of a trajectory.

    Attributes:
        until: The end of the part, s; it begins where the one before ends.
        tool: Position of the tool centre point in tool0, (3,) m.
        speed: Its highest speed, m/s; infinite for none.
        rotation_speed: Highest angular speed, rad/s; infinite for none.
    """

    until: float
    tool: Array
    speed: float
    rotation_speed: float


def tool_speeds(
    trajectory: Trajectory, robot: BaseRobotModel, sections: Sequence[ToolSection]
) -> dict[str, LimitUse]:
    """The highest use of each speed limit, by quantity; nothing where none is limited."""
    worst: dict[str, LimitUse] = {}
    begin = 0.0
    for section in sections:
        limits = (('speed', section.speed, 'm/s'), ('angular speed', section.rotation_speed, 'rad/s'))
        if np.isfinite([limit for _, limit, _ in limits]).any():
            count = max(4, int(np.ceil((section.until - begin) / TOOL_PERIOD)))
            # At its ends, where the limits of two parts meet, both hold.
            times = np.linspace(begin, section.until, count + 1)
            speeds = _speeds(trajectory, robot, section.tool, times)
            for values, (quantity, limit, unit) in zip(speeds, limits, strict=True):
                row = int(np.argmax(values))
                ratio, value = float(values[row]) / limit, float(values[row])
                if quantity not in worst or ratio > worst[quantity].ratio:
                    worst[quantity] = LimitUse(
                        quantity, ratio, 'the tool', float(times[row]), value, limit, unit
                    )
        begin = section.until
    return worst


def _speeds(trajectory: Trajectory, robot: BaseRobotModel, tool: Array, times: Array) -> tuple[Array, Array]:
    """Speed (m/s) and angular speed (rad/s) of a tool at times (m,), each (m,)."""
    q, q_dot, _ = trajectory.sample(times)
    twists = np.array([robot.jacobian(row) @ rate for row, rate in zip(q, q_dot, strict=True)])
    arms = robot.tool_poses(q)[1] @ tool
    velocity = twists[:, :3] + np.cross(twists[:, 3:], arms)
    return np.linalg.norm(velocity, axis=1), np.linalg.norm(twists[:, 3:], axis=1)

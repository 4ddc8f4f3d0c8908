"""WheelContact: a wheel at a robot's tool over level soil, and the wrench that a sensor there measures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.terramechanics.wheel_soil_model import WheelForces, WheelSoilModel
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, positive, read_only

# A wheel that rolls back less than this, as a robot does when it stops, still pulls as before.
BACKLASH: Final = 1e-3  # m
LARGEST_SLIP: Final = 0.95  # that a wheel's drive can be asked for
UP: Final = read_only([0.0, 0.0, 1.0])
AIR: Final = read_only(np.zeros(6))
NO_FORCES: Final = WheelForces(0.0, 0.0, 0.0)
LEVEL: Final = 1e-6  # smallest length of a direction's level part


@dataclass(frozen=True, eq=False)
class SoilBed:
    """A bed of level soil in the robot's base frame.

    Attributes:
        height: Of its surface, m.
        lower: Its smallest x and y, (2,) m.
        upper: Its largest x and y, (2,) m.

    Raises:
        InvalidInputError: not finite numbers, or a bed without area.
    """

    height: float
    lower: Array
    upper: Array

    def __post_init__(self) -> None:
        finite_vector([self.height], 1, 'height')
        for name in ('lower', 'upper'):
            object.__setattr__(self, name, read_only(finite_vector(getattr(self, name), 2, name)))
        for axis, side in zip('xy', (self.upper - self.lower).tolist(), strict=True):
            positive(side, f'{axis} side of the soil bed', 'm')


@dataclass(frozen=True, eq=False)
class ContactStep:
    """A wheel and its soil at one instant.

    Attributes:
        wrench: Force (N) and torque (N m) of the soil on the tool, (6,), at tool0 in its axes.
        forces: On the wheel.
        sinkage: m; negative above the soil or beside it.
        slip: Of the wheel while it touches.
    """

    wrench: Array
    forces: WheelForces
    sinkage: float
    slip: float


class WheelContact:
    """A wheel that is held by a robot, with a drive that keeps a commanded slip at any speed of the hub.

    A wheel that touches down is carried by Bekker's pressure; over the first length of its contact that it
    rolls, the forces change to those of a rolling wheel, and they stay so when it stops. This transition is
    made up here; laboratories evaluate what comes after it. The soil is fresh wherever the wheel touches down
    and wherever it rolls to. The wheel stands upright; a lean is not taken into account.

    Args:
        model: Wheel and soil.
        bed: Where the soil is.
        hub: Of the wheel in tool0, (3,) m.
        forward: Where the wheel rolls to, in tool0, (3,); its length does not matter.

    Raises:
        InvalidInputError: another shape, or a direction without length.
    """

    def __init__(self, model: WheelSoilModel, bed: SoilBed, *, hub: Array, forward: Array) -> None:
        self.model, self.bed = model, bed
        self.hub = read_only(finite_vector(hub, 3, 'hub'))
        ahead = finite_vector(forward, 3, 'forward')
        self.forward = read_only(ahead / positive(float(np.linalg.norm(ahead)), 'length of forward'))
        self.slip = 0.0
        """That the wheel's drive keeps; what is not in 0 to `LARGEST_SLIP` counts as the nearest of these."""
        self._touched: Array | None = None  # where the hub was when the wheel touched down
        self._rolled = 0.0  # part of the transition to rolling that is done
        self._sense = 1.0  # of rolling
        self._farthest = 0.0  # way in this sense, m

    def of_robot(self, robot: BaseRobotModel, q: Array) -> ContactStep:
        """The contact of a robot at joint positions (n,), rad (m)."""
        return self.step(robot.pose(q))

    def step(self, tool: Pose) -> ContactStep:
        """The contact of a tool at its next pose in the base frame.

        A wheel that is deeper than its radius is held as one at its radius. One whose direction is straight
        up or down does not roll.
        """
        arm = tool.T @ self.hub
        hub = tool.r + arm
        ahead = self._ahead(tool.T)
        sinkage = self._sinkage(hub)
        if sinkage <= 0.0:
            self._touched, self._rolled = None, 0.0
            return ContactStep(AIR, NO_FORCES, sinkage, 0.0)
        if self._touched is None:
            self._touched, self._sense, self._farthest = hub[:2], 1.0, 0.0
        self._take_sense(float(ahead[:2] @ (hub[:2] - self._touched)))
        forces, slip = self._forces(math.hypot(*(hub[:2] - self._touched)), sinkage)
        ahead = ahead * self._sense
        force = forces.load * UP + forces.drawbar_pull * ahead
        torque = _cross(arm, force) - forces.torque * _cross(UP, ahead)
        wrench = np.concatenate([tool.T.T @ force, tool.T.T @ torque])
        return ContactStep(read_only(wrench), forces, sinkage, slip)

    def _ahead(self, T: Array) -> Array:
        level = T @ self.forward
        level[2] = 0.0
        length = math.hypot(*level)
        return np.asarray(level / length) if length >= LEVEL else np.zeros(3)

    def _sinkage(self, hub: Array) -> float:
        inside = bool((hub[:2] >= self.bed.lower).all() and (hub[:2] <= self.bed.upper).all())
        radius = self.model.wheel.radius
        sinkage = self.bed.height - (float(hub[2]) - radius)
        return sinkage if inside else min(sinkage, -radius)

    def _take_sense(self, way: float) -> None:
        """Find out to which side the wheel rolls; its way is counted from where it touched down, m."""
        self._farthest = self._sense * max(self._sense * self._farthest, self._sense * way)
        if self._sense * (self._farthest - way) > BACKLASH:
            self._sense, self._farthest = -self._sense, way

    def _forces(self, way: float, sinkage: float) -> tuple[WheelForces, float]:
        depth = min(sinkage, self.model.wheel.radius)
        slip = min(max(self.slip, 0.0), LARGEST_SLIP)
        entry, _, leave = self.model.angles(depth, slip)
        length = self.model.wheel.radius * (entry - leave)
        self._rolled = max(self._rolled, min(1.0, way / length))
        parts = []
        if self._rolled < 1.0:
            parts.append((1.0 - self._rolled, self.model.standing(depth)))
        if self._rolled > 0.0:
            parts.append((self._rolled, self.model.forces(depth, slip)))
        return WheelForces(
            sum(part * forces.load for part, forces in parts),
            sum(part * forces.drawbar_pull for part, forces in parts),
            sum(part * forces.torque for part, forces in parts),
        ), slip


def _cross(a: Array, b: Array) -> Array:
    """The cross product of (3,) and (3,); numpy's own takes ten times longer."""
    (p, q, r), (x, y, z) = a.tolist(), b.tolist()
    return np.array([q * z - r * y, r * x - p * z, p * y - q * x])

"""JogCommand: what a jog button commands."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, Literal, get_args

import numpy as np

from robots_controller.pendant.pendant_state import JogSpeeds
from robots_core.errors import InvalidInputError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array
from robots_planning.guidance.teach_box import ROTATION_SPEED

JogFrame = Literal['axes', 'tool', 'base', 'taught']
JOG_FRAMES: Final[tuple[JogFrame, ...]] = get_args(JogFrame)
COMPONENTS: Final = 6
"""Of a twist: along x, y, z, about x, y, z."""


@dataclass(frozen=True)
class JogCommand:
    """One axis, or one direction of the tool.

    Attributes:
        frame: 'axes' for one axis alone; or the tool, along and about axes of 'tool', 'base' or a 'taught'
            frame.
        index: Of the axis, or of the component of the twist, from 0.
        share: Part of the highest jog speed, -1..1.
        taught: Orientation of the taught frame in the robot's base, (3, 3).
    """

    frame: JogFrame
    index: int
    share: float
    taught: Array | None = field(default=None, compare=False)

    @classmethod
    def from_key(cls, key: str, speed: float, num_axes: int, taught: Array | None = None) -> JogCommand:
        """The command of a button, such as 'axes 0 +' or 'tool 2 -', at a part of the highest jog speed.

        Raises:
            InvalidInputError: no such button or speed.
        """
        frame, index, sign, *rest = [*key.split(' '), '', '', '']
        if frame not in JOG_FRAMES or not index.isdecimal() or sign not in ('+', '-') or any(rest):
            raise InvalidInputError(
                f'jog button {key!r} is unknown; valid is a frame ({", ".join(JOG_FRAMES)}), an index '
                f"from 0 and a sign, such as 'axes 0 +'"
            )
        count = num_axes if frame == 'axes' else COMPONENTS
        if int(index) >= count:
            raise InvalidInputError(f'jog index = {index} must be in [0, {count - 1}] for {frame!r}')
        if not (math.isfinite(speed) and 0.0 < speed <= 1.0):
            raise InvalidInputError(f'jog speed = {speed:g} must be in (0, 1]')
        if frame == 'taught' and taught is None:
            raise InvalidInputError('no frame is chosen to jog in; choose a taught point or the base')
        return cls(frame, int(index), speed if sign == '+' else -speed, taught)

    @property
    def tool_frame(self) -> Literal['tool', 'base']:
        """The axes of `twist`."""
        return 'tool' if self.frame == 'tool' else 'base'

    def velocity(self, axes: AxesData, speeds: JogSpeeds) -> Array:
        """Velocities of the axes, (n,), rad/s (m/s)."""
        velocity = np.zeros(axes.num_axes)
        velocity[self.index] = self.share * speeds.fraction * axes.velocity[self.index]
        return velocity

    def twist(self, speeds: JogSpeeds) -> Array:
        """Twist of the tool, (6,), m/s and rad/s, in `tool_frame`."""
        return self.share * self.direction() * (speeds.tool if self.index < 3 else ROTATION_SPEED)

    def direction(self) -> Array:
        """Unit twist of the tool, forwards, (6,), in `tool_frame`."""
        twist = np.zeros((2, 3))
        twist.flat[self.index] = 1.0
        turned: Array = twist if self.taught is None else twist @ np.asarray(self.taught).T
        return turned.ravel()

"""JogCommand: what a jog button commands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np

from robots_controller.pendant.pendant_state import JogSpeeds
from robots_core.errors import InvalidInputError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array
from robots_planning.teach_box import ROTATION_SPEED

JogFrame = Literal['axes', 'tool', 'base']
JOG_FRAMES: Final[tuple[JogFrame, ...]] = get_args(JogFrame)
COMPONENTS: Final = 6
"""Of a twist: along x, y, z, about x, y, z."""


@dataclass(frozen=True)
class JogCommand:
    """One axis, or one direction of the tool.

    Attributes:
        frame: 'axes' for one axis alone; or the tool, along and about axes of 'tool' or 'base'.
        index: Of the axis, or of the component of the twist, from 0.
        share: Part of the highest jog speed, -1..1.
    """

    frame: JogFrame
    index: int
    share: float

    @classmethod
    def from_key(cls, key: str, speed: float, num_axes: int) -> JogCommand:
        """The command of a button, such as 'axes 0 +' or 'tool 2 -'.

        Args:
            key: Of the button.
            speed: Part of the highest jog speed, 0..1.
            num_axes: The robot's.

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
        return cls(frame, int(index), speed if sign == '+' else -speed)

    def velocity(self, axes: AxesData, speeds: JogSpeeds) -> Array:
        """Velocities of the axes, (n,), rad/s (m/s)."""
        velocity = np.zeros(axes.num_axes)
        velocity[self.index] = self.share * speeds.fraction * axes.velocity[self.index]
        return velocity

    def twist(self, speeds: JogSpeeds) -> Array:
        """Twist of the tool, (6,), m/s and rad/s, in `frame`."""
        twist = np.zeros(COMPONENTS)
        twist[self.index] = self.share * (speeds.tool if self.index < 3 else ROTATION_SPEED)
        return twist

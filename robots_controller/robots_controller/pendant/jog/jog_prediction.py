"""JogPrediction: what will stop a jog, before it does."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from robots_controller.pendant.jog.jog_command import JogCommand
from robots_controller.pendant.pendant_state import JogSpeeds
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.guidance.teach_box import TeachBox
from robots_planning.motion_settings import MotionSettings, frame

HORIZON: Final = 3.0  # s
STEP: Final = 0.1  # s


@dataclass(frozen=True)
class PredictedStop:
    """What will stop or slow a jog, and when.

    Attributes:
        time: Until then, s.
        limits: What it is, as in `TeachStep`: 'A2 position upper', 'A5 velocity lower', or out of reach.
    """

    time: float
    limits: tuple[str, ...]


class JogPrediction:
    """Continues a jog as the teach box will, some seconds ahead, in steps that are coarse and fast.

    An instance keeps scratch memory: use one per thread.
    """

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot
        self._box = lru_cache(1)(self._make_box)

    def ahead(
        self, jog: JogCommand, q: Array, speeds: JogSpeeds, settings: MotionSettings
    ) -> PredictedStop | None:
        """What the jog will meet from joint positions q, (n,), rad (m); None for nothing within `HORIZON`."""
        axes, box = self._robot.axes_data, self._box(speeds, settings.tool, settings.hold)
        box.place(np.clip(q, axes.lower, axes.upper))
        time = 0.0
        while time < HORIZON:
            if jog.frame == 'axes':
                box.jog_axes(jog.velocity(axes, speeds), time)
            else:
                box.jog_tool(jog.twist(speeds), time, jog.tool_frame)
            step = box.step(time)
            if step.limits:
                return PredictedStop(time, step.limits)
            time += STEP
        return None

    def _make_box(self, speeds: JogSpeeds, tool: tuple[float, ...], hold: str) -> TeachBox:
        return TeachBox(
            self._robot,
            STEP,
            self._robot.home,
            speed_fraction=speeds.fraction,
            tool_speed=speeds.tool,
            tool=frame(tool, 'tool'),
            hold=hold,
        )

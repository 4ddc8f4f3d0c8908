"""The start of motions that begin at rest: a robot that stands."""

from typing import Final

import numpy as np

from robots_core.errors import PlanningError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

REST_SPEED: Final = 1e-5  # rad/s (m/s); a reference this slow is rounding of one that stands


def check_standing(q_dot: Array, axes: AxesData) -> None:
    """Check that a reference stands.

    Args:
        q_dot: Its velocity, (n,) rad/s (m/s).
        axes: The robot's.

    Raises:
        PlanningError: it moves; names the fastest axis.
    """
    fastest = int(np.argmax(np.abs(q_dot)))
    if abs(q_dot[fastest]) > REST_SPEED:
        raise PlanningError(
            f'the robot is still moving: the reference of {axes.names[fastest]} has '
            f'{q_dot[fastest]:.4g} {axes.unit(fastest)}/s; wait until it stands'
        )

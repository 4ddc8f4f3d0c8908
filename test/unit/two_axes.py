"""A robot of two axes, as limits alone, and its motions: for blocks of the controller."""

import numpy as np

from robots_core.robot_model.axes_data import AxesData
from robots_planning.trajectory import Trajectory


def two_axes(acceleration: tuple[float, float], jerk: tuple[float, float] = (20.0, 12.0)) -> AxesData:
    """Axes with these limits, rad/s^2 and rad/s^3."""
    return AxesData(
        names=('A1', 'A2'),
        lower=np.array([-3.0, -2.0]),
        upper=np.array([3.0, 2.0]),
        velocity=np.array([2.0, 1.0]),
        acceleration=np.array(acceleration),
        jerk=np.array(jerk),
        effort=np.ones(2),
    )


def quintic(start: np.ndarray, goal: np.ndarray, duration: float = 2.0) -> Trajectory:
    """Minimum-jerk motion between two joint positions (2,)."""
    zero = np.zeros((2, 2))
    return Trajectory(np.array([0.0, duration]), np.array([start, goal]), zero, zero)

"""The status of torques: which axis is nearest to its limit, or past it."""

import numpy as np

from robots_core.robot_model.axes_data import AxesData
from robots_core.status import Level, Status
from robots_core.validation import Array


def torque_status(axes: AxesData, tau: Array) -> Status:
    """Of torques (n,), N m (N), by the axis that uses the largest part of its limit; WARN past it."""
    part = np.abs(tau) / axes.effort
    worst = int(part.argmax())
    name, limit = axes.names[worst], float(axes.effort[worst])
    values = {'joint': name, 'torque': float(tau[worst]), 'limit': limit}
    if part[worst] <= 1.0:
        return Status('torques', 'ready', values=values)
    text = f'torque of {name} is past its limit of {limit:g} {axes.unit(worst, "torque")}'
    return Status('torques', text, Level.WARN, values)

"""torque_status: the axis nearest to its limit, and whether it is past it."""

from __future__ import annotations

import pytest

from robots_core import load_robot_model
from robots_core.blocks.multibody.torque_status import torque_status
from robots_core.status import Level

AXES = load_robot_model('ur5e').axes_data


@pytest.mark.parametrize('axis', range(6))
@pytest.mark.parametrize('sign', [-1.0, 1.0])
def test_the_part_of_the_limit_counts_and_not_the_torque(axis: int, sign: float) -> None:
    tau, limit, name = 0.5 * AXES.effort, float(AXES.effort[axis]), AXES.names[axis]
    tau[axis] = sign * limit
    status = torque_status(AXES, tau)
    assert (status.level, status.text) == (Level.OK, 'ready')
    assert status.values == {'joint': name, 'torque': sign * limit, 'limit': limit}
    tau[axis] *= 1.001
    status = torque_status(AXES, tau)
    assert status.level is Level.WARN
    assert status.text == f'torque of {name} is past its limit of {limit:g} N m'

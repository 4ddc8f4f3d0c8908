"""How often the controller checks the feedback."""

from __future__ import annotations

import pytest

from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_rates import (
    FEEDBACK_RATE,
    HOLDING_RATE,
    ControllerRates,
    idle_latency_for,
)
from robots_controller.control.controller_settings import ControllerSettings
from robots_core import BaseRobotModel, load_robot_model

SECONDS = 2.0


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('bello_bot')


@pytest.mark.parametrize('rate', [10.0, 100.0, 250.0, 300.0, 1000.0, 2000.0])
@pytest.mark.parametrize('timeout', [0.02, 0.05, 0.5])
def test_a_standing_robot_that_is_alive_is_never_lost(robot: BaseRobotModel, rate: float, timeout: float):
    if timeout * rate < 2.0:
        timeout = 2.0 / rate  # no check can come more often than the cycles
    controller = Controller(robot.axes_data, ControllerSettings(period=1.0 / rate, feedback_timeout=timeout))
    rates = ControllerRates(rate, timeout)
    controller.step(0.0, robot.home)
    checks = 0
    for cycle in range(1, round(SECONDS * rate)):
        due = rates.feedback_due(cycle, controller)
        checks += due
        controller.step(cycle / rate, robot.home if due else None)
        assert controller.state is ControllerState.HOLDING
        assert not controller._feedback.lost
    if timeout == 0.5:
        # A check takes time that nothing else needs, so that there are no more than meant.
        assert checks / SECONDS <= 1.1 * HOLDING_RATE < FEEDBACK_RATE


def test_a_robot_that_is_not_heard_of_is_lost(robot: BaseRobotModel):
    controller = Controller(robot.axes_data, ControllerSettings(period=0.004, feedback_timeout=0.5))
    controller.step(0.0, robot.home)
    lost = []
    for cycle in range(1, 150):
        controller.step(0.004 * cycle, None)
        lost.append(controller._feedback.lost)
    assert 124 <= lost.index(True) <= 131  # not every period looks for a loss
    assert all(lost[131:])


def test_processors_are_kept_awake_for_fast_loops_alone():
    # That takes power. `controller_node` takes a negative latency for no wish at all.
    assert [idle_latency_for(rate) for rate in (500.0, 1000.0, 2000.0)] == [0.0] * 3
    assert all(idle_latency_for(rate) < 0.0 for rate in (10.0, 250.0, 499.0))

"""ControlPeriod: the order of messages in a period; ControllerCondition: what counts first."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.control_period import ControlPeriod
from robots_controller.control.controller_condition import REFUSAL_SHOWN, ControllerCondition
from robots_controller.control.stops.faults import Fault
from robots_controller.control.stops.stop_latch import StopState
from robots_controller.control.zones.shared_zone import ZoneState
from robots_core.blocks import Zone
from robots_core.errors import NotNowError
from robots_core.status import Level

from . import zone_cell
from .control_rig import GOAL, PERIOD, START, ControlRig
from .two_axes import quintic


class Transport(ControlRig):
    """A rig that records the order of its messages.

    Args:
        ahead: See `ControlPeriod`.
    """

    def __init__(self, *, ahead: bool = False) -> None:
        self.order: list[str] = []
        self.claims: list[Mapping[str, ZoneState]] = []
        self.active = True
        super().__init__()
        self.period = self.period_of(self.loop, ahead=ahead)

    def period_of(self, loop: ControlLoop, *, ahead: bool) -> ControlPeriod:
        """The periods of a loop with these messages."""
        return ControlPeriod(loop, feedback=self.feedback, send=self.send, claim=self.claim, ahead=ahead)

    def feedback(self) -> np.ndarray:
        self.order.append('feedback')
        return self.q

    def send(self, reference: np.ndarray, _now: float) -> None:
        self.order.append('reference')
        self.q = reference[0].copy()

    def claim(self, states: Mapping[str, ZoneState]) -> None:
        self.order.append('claims')
        self.claims.append(states)

    def stop_changed(self, state: StopState) -> None:
        super().stop_changed(state)
        self.order.append('stop' if state.drives_on else 'drives off')

    def progress(self, progress: float) -> None:
        super().progress(progress)
        self.order.append('progress')

    def periods(self, count: int) -> list[list[str]]:
        """Run; returns the order in each period."""
        found = []
        for _ in range(count):
            self.order = []
            self.period.run(self.now, active=self.active)
            found.append(self.order)
        return found


@pytest.mark.parametrize('ahead', [False, True])
def test_feedback_is_taken_once_for_each_period_in_which_it_is_due(ahead: bool) -> None:  # noqa: FBT001
    transport = Transport(ahead=ahead)
    transport.loop.follow(quintic(START, GOAL, 1.0), '1')
    due, taken = 0, 0
    for _ in range(300):
        due += transport.loop.feedback_due
        (order,) = transport.periods(1)
        taken += order.count('feedback')
        if 'feedback' in order and taken > 1:
            assert order.index('feedback') == (len(order) - 1 if ahead else 0)
    assert taken == due + (ahead and transport.loop.feedback_due)
    assert due < 300
    assert transport.run_until_result().ok


def test_reports_follow_the_reference(transport: Transport) -> None:
    transport.loop.follow(quintic(START, GOAL, 1.0), '1')
    for order in transport.periods(50)[2:]:
        assert order.index('reference') < order.index('progress')


def test_drives_are_switched_off_before_a_reference_that_they_need_not_follow(transport: Transport) -> None:
    transport.loop.follow(quintic(START, GOAL, 1.0), '1')
    transport.periods(100)
    transport.loop.trip(Fault.EMERGENCY_STOP, 'button')
    orders = transport.periods(300)
    (stopped,) = (order for order in orders if 'stop' in order)
    assert stopped.index('reference') < stopped.index('stop')
    (off,) = (order for order in orders if 'drives off' in order)
    assert off.index('drives off') < off.index('reference')
    assert orders.index(off) > orders.index(stopped)


def test_an_inactive_controller_sends_no_reference_of_a_robot_that_stands(transport: Transport) -> None:
    transport.active = False
    assert not any('reference' in order for order in transport.periods(10))
    transport.loop.follow(quintic(START, GOAL, 1.0), '1')
    assert all('reference' in order for order in transport.periods(100)[1:])


def test_claims_are_reported_when_they_change() -> None:
    region = zone_cell.wall(0.6).region
    cell = zone_cell.Cell(Zone('press', region, 'out', 'tool', shared_with=('/b',)), closed=None, name='/a')
    transport = Transport()
    period = transport.period_of(cell.loop, ahead=False)
    transport.q = cell.q
    for k in range(3):
        period.run(cell.now + k * PERIOD)
    assert transport.claims == [cell.zones and cell.zones.states]
    assert transport.order.count('claims') == 1


def test_of_several_conditions_the_one_that_holds_the_robot_longest_is_told(transport: Transport) -> None:
    condition = ControllerCondition(transport.loop.controller)
    transport.periods(2)
    now = transport.now
    assert condition.at(now) == (Level.OK, 'ready')
    transport.loop.wait_for('no sign of life')
    transport.periods(1)
    assert condition.at(now) == (Level.WARN, 'no sign of life')
    condition.stream_refused(NotNowError('too fast'), now)
    assert condition.at(now) == (Level.WARN, 'joint_trajectory: too fast')
    assert condition.at(now + REFUSAL_SHOWN) == (Level.WARN, 'no sign of life')
    transport.loop.stop('a person')
    transport.periods(1)
    assert condition.at(now) == (Level.ERROR, 'stopped until ~/reset: a person')
    assert condition.at(now, 'not active') == (Level.WARN, 'not active')


@pytest.fixture
def transport() -> Transport:
    return Transport()

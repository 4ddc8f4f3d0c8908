"""Robots that share a zone are in it one after the other."""

from __future__ import annotations

from collections import deque

import numpy as np
import pytest

from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.control.zones.shared_zone import ZoneState
from robots_core.blocks import Zone
from robots_core.errors import InvalidInputError
from robots_planning import LinearJoint

from .zone_cell import PERIOD, ROBOT, START, Cell, turned, wall


class Pair:
    """Two robots that share the zone beyond an angle; what they say takes some periods."""

    def __init__(self, angle: float, latency: int = 7) -> None:
        self.zone = wall(angle)
        region = self.zone.region
        self.cells = {
            name: Cell(Zone('press', region, 'out', 'tool', shared_with=(other,)), closed=None, name=name)
            for name, other in (('/a', '/b'), ('/b', '/a'))
        }
        self.under_way: deque[list[tuple[Cell, str, dict[str, ZoneState]]]] = deque([[]] * latency)

    def step(self, *names: str) -> None:
        """One period; of these robots, or of both."""
        a, b = self.cells['/a'], self.cells['/b']
        assert a.zones is not None
        assert b.zones is not None
        self.under_way.append([(b, '/a', a.zones.states), (a, '/b', b.zones.states)])
        for receiver, sender, states in self.under_way.popleft():
            receiver.loop.receive_zones(sender, states)
        for name in names or ('/a', '/b'):
            self.cells[name].step()
        assert sum(cell.clearance(self.zone) < 0.0 for cell in (a, b)) <= 1


def test_two_robots_are_in_a_shared_zone_one_after_the_other() -> None:
    pair = Pair(0.6)
    planner = LinearJoint(ROBOT)
    there, back = planner.generate(START, turned(1.0)), planner.generate(turned(1.0), START)
    waited = dict.fromkeys(pair.cells, False)
    for cell in pair.cells.values():
        for motion, id_ in ((there, 'there'), (back, 'back')):
            cell.loop.follow(motion, id_)
    while any(len(cell.results) < 2 for cell in pair.cells.values()):
        pair.step()
        for name, cell in pair.cells.items():
            waited[name] |= cell.held()
            assert cell.now < 20.0
    assert all(result.ok for cell in pair.cells.values() for result in cell.results)
    assert sum(waited.values()) == 1
    assert not any(cell.controller.stops.latched for cell in pair.cells.values())


def test_a_robot_does_not_wait_where_the_zone_is_free_in_time() -> None:
    pair = Pair(1.0)
    alone = Cell()
    motion = LinearJoint(ROBOT).generate(START, turned(2.0))
    pair.cells['/a'].loop.follow(motion, 'motion')
    alone.loop.follow(motion, 'motion')
    while not alone.results:
        pair.step()
        alone.step()
    np.testing.assert_array_equal(pair.cells['/a'].references, alone.references)


def test_a_robot_waits_for_one_that_is_silent() -> None:
    pair = Pair(0.6)
    pair.cells['/a'].loop.follow(LinearJoint(ROBOT).generate(START, turned(1.0)), 'motion')
    for _ in range(1000):
        pair.step('/a')
    assert pair.cells['/a'].controller.obstacle == "the border of zone 'press', which /b has not granted"
    while not pair.cells['/a'].results:
        pair.step()
    assert pair.cells['/a'].results[-1].ok


def test_jogging_waits_for_a_shared_zone_too() -> None:
    pair = Pair(0.6)
    a, b = pair.cells['/a'], pair.cells['/b']
    b.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.0)), 'motion')
    while not b.results:
        pair.step()
    jog = np.array([0.5, 0.0, 0.0])
    for _ in range(500):
        a.loop.stream(StreamPoint(a.q + PERIOD * jog, jog, np.zeros(3), a.now + PERIOD), 'jog')
        pair.step()
    assert 0.0 < a.clearance(pair.zone) < 0.01
    b.loop.follow(LinearJoint(ROBOT).generate(b.q, START), 'back')
    for _ in range(1000):
        a.loop.stream(StreamPoint(a.q + PERIOD * jog, jog, np.zeros(3), a.now + PERIOD), 'jog')
        pair.step()
    assert a.clearance(pair.zone) < 0.0


def test_a_simulated_robot_shares_with_nobody() -> None:
    cell = Cell(Zone('press', wall(0.6).region, 'out', 'tool', shared_with=('/b',)), closed=None)
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.0)), 'motion')
    cell.run()
    assert cell.results[-1].ok


def test_a_robot_does_not_share_with_itself() -> None:
    with pytest.raises(InvalidInputError, match='is shared with /a itself'):
        Cell(Zone('press', wall(0.6).region, 'out', 'tool', shared_with=('/a',)), name='/a')

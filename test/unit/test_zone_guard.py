"""The controller holds motions and streams before closed borders, and stops a robot that is across one."""

from __future__ import annotations

import numpy as np
import pytest

from robots_controller.control.controller import ControllerState
from robots_controller.control.stops.faults import Fault
from robots_controller.control.zones.zone_guard import ZoneGuard
from robots_core import Pose
from robots_core.blocks import HalfSpace, PlacedBox, Zone
from robots_core.blocks.collision.scene import AttachedObject, Scene
from robots_core.robot_model.shapes import Box, Capsule
from robots_planning import LinearJoint, LinearJointAxes

from .zone_cell import PERIOD, ROBOT, START, SWITCHED, Cell, tool, turned, wall


@pytest.mark.parametrize('border', [0.05, 0.4, 0.9, 1.15, 1.19])
@pytest.mark.parametrize('planner', [LinearJoint, LinearJointAxes])
def test_a_motion_waits_on_its_path_before_a_closed_border(border: float, planner: type[LinearJoint]) -> None:
    zone, target = wall(border), turned(1.2) + np.array([0.0, 0.1, -0.2])
    cell = Cell(zone)
    motion = planner(ROBOT).generate(START, target)
    cell.loop.follow(motion, 'motion')
    cell.run(until=cell.held)
    assert 0.0 < cell.clearance(zone) < 3e-3
    assert "'press', which is closed" in cell.controller.obstacle
    cell.step(500)
    assert cell.clearance(zone) > 0.0
    assert not cell.references[-1][1].any()
    cell.loop.close_zones(())
    cell.run()
    assert [result.message for result in cell.results] == ['reached']
    np.testing.assert_allclose(cell.q, target, atol=1e-9)
    assert cell.controller.obstacle == ''


def test_an_open_border_changes_nothing() -> None:
    free, open_ = Cell(), Cell(wall(0.5), closed=())
    motion = LinearJoint(ROBOT).generate(START, turned(1.2))
    for cell in (free, open_):
        cell.loop.follow(motion, 'motion')
        cell.run()
    np.testing.assert_array_equal(free.references, open_.references)


def test_a_border_that_closes_with_room_to_brake_holds_the_robot() -> None:
    zone = wall(0.9)
    cell = Cell(zone, closed=())
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=lambda: cell.clearance(zone) < 0.45)  # 0.38 m are needed at 1.75 rad/s
    cell.loop.close_zones(('press',))
    cell.run(until=cell.held)
    assert 0.0 < cell.clearance(zone) < 3e-3
    assert not cell.controller.stops.latched


def test_a_border_that_closes_in_front_of_the_robot_is_a_fault() -> None:
    zone = wall(0.6)
    cell = Cell(zone, closed=())
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=lambda: cell.clearance(zone) < 0.02)
    speed = np.abs(cell.references[-1][1][0])
    cell.loop.close_zones(('press',))
    closed = len(cell.references)
    cell.run()
    assert cell.stops[-1].fault is Fault.ZONE_VIOLATED
    assert 'the tool is' in cell.stops[-1].reason
    assert "mm inside zone 'press'" in cell.stops[-1].reason
    assert not cell.results[-1].ok
    braked = next(k for k, ref in enumerate(cell.references[closed:]) if not ref[1].any())
    shortest = speed / ROBOT.axes_data.acceleration[0]
    assert braked * PERIOD < 1.5 * shortest + 0.05  # as fast as the limits permit, and the average's window


def test_a_robot_across_a_border_that_closes_may_leave_after_a_reset() -> None:
    zone = wall(0.6)
    cell = Cell(zone, closed=())
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.0)), 'in')
    cell.run()
    cell.loop.close_zones(('press',))
    cell.step(10)
    assert cell.stops[-1].fault is Fault.ZONE_VIOLATED
    assert not cell.stops[-1].drives_on
    cell.loop.reset()
    cell.step(10)
    assert cell.controller.state is ControllerState.HOLDING
    # Not further in:
    cell.loop.follow(LinearJoint(ROBOT).generate(cell.q, turned(1.3)), 'further')
    cell.step(200)
    np.testing.assert_allclose(cell.q, turned(1.0), atol=1e-6)
    cell.loop.request('cancel')
    cell.run()
    cell.loop.follow(LinearJoint(ROBOT).generate(cell.q, START), 'back')
    cell.run()
    assert cell.results[-1].ok
    assert not cell.controller.stops.latched
    # Nor in again:
    cell.loop.follow(LinearJoint(ROBOT).generate(cell.q, turned(1.0)), 'again')
    cell.run(until=cell.held)
    assert 0.0 < cell.clearance(zone) < 3e-3


def test_a_person_may_jog_back_and_not_further() -> None:
    zone = wall(0.2)
    cell = Cell(zone, closed=())
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(0.4)), 'in')
    cell.run()
    cell.loop.close_zones(('press',))
    cell.step(10)
    cell.loop.reset()
    cell.step(10)
    cell.jog(np.array([0.5, 0.0, 0.0]), 100)
    assert cell.q[0] == pytest.approx(turned(0.4)[0], abs=1e-6)
    assert "'press', which is closed" in cell.controller.obstacle
    cell.jog(np.array([-0.5, 0.0, 0.0]), 300)
    assert cell.clearance(zone) > 0.1
    assert not cell.controller.stops.latched


@pytest.mark.parametrize(('speed', 'border'), [(0.05, 0.1), (0.5, 0.8), (1.8, 0.8)])
@pytest.mark.parametrize('bend', [0.0, 0.3])
def test_a_stream_brakes_before_a_closed_border(speed: float, border: float, bend: float) -> None:
    zone = wall(border)
    cell = Cell(zone)
    cell.jog(np.array([speed, bend * speed, -bend * speed]), round(2.0 * border / speed / PERIOD))
    assert 0.0 < cell.clearance(zone) < 0.01
    assert "'press', which is closed" in cell.controller.obstacle
    velocity = np.array([reference[1] for reference in cell.references])
    assert np.abs(np.diff(velocity, axis=0)).max() <= ROBOT.axes_data.acceleration.max() * PERIOD * 1.001
    cell.jog(np.array([-speed, 0.0, 0.0]), round(0.5 * border / speed / PERIOD))
    assert cell.clearance(zone) > 0.05 * border
    assert not cell.controller.stops.latched


def test_a_stream_moves_along_a_border() -> None:
    below = Zone('press', HalfSpace([0, 0, tool(START)[2] - 0.002], [0, 0, -1]), 'out', 'tool', SWITCHED)
    cell = Cell(below)
    cell.jog(np.array([1.0, 0.0, 0.0]), 100)
    assert cell.q[0] > START[0] + 0.2


def test_a_motion_that_passes_into_another_stops_on_the_one_before() -> None:
    planner = LinearJoint(ROBOT)
    first = planner.generate(START, turned(1.2))
    join = round(0.5 * first.duration, 9)
    state = first.sample(join)
    zone = wall(float(state[0][0] - START[0]) + 0.01)
    second = planner.generate_moving(state, turned(1.5))
    cell = Cell(zone)
    cell.loop.follow(first, 'first')
    cell.run(until=lambda: cell.controller.progress > 0.1)
    cell.loop.follow(second, 'second', join_time=join)
    cell.run(until=cell.held)
    assert 0.0 < cell.clearance(zone) < 3e-3
    cell.loop.close_zones(())
    cell.run()
    np.testing.assert_allclose(cell.q, turned(1.5), atol=1e-9)


def test_a_speed_limit_and_a_border_hold_together() -> None:
    zone = wall(0.8)
    cell = Cell(zone, limit=0.3)
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=cell.held)
    assert 0.0 < cell.clearance(zone) < 3e-3
    places = np.array([tool(reference[0]) for reference in cell.references])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / PERIOD <= 0.3


def test_of_several_zones_the_next_closed_one_holds() -> None:
    near, far = wall(0.4), wall(0.9)
    near = Zone(
        'near', PlacedBox(Box((0.2, 0.2, 0.2)), Pose(tool(turned(0.4)), np.eye(3))), 'out', 'tool', SWITCHED
    )
    cell = Cell(near, far, closed=('near', 'press'))
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=cell.held)
    assert "'near'" in cell.controller.obstacle
    cell.loop.close_zones(('press',))
    cell.run(until=lambda: cell.held() and "'press', which is closed" in cell.controller.obstacle)
    assert 0.0 < cell.clearance(far) < 3e-3
    # What lies behind the robot does not hold it.
    cell.loop.close_zones(('near',))
    cell.run()
    np.testing.assert_allclose(cell.q, turned(1.2), atol=1e-9)


def test_a_stopped_program_cancels_the_motion_of_a_robot_that_waits() -> None:
    cell = Cell(wall(0.4))
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=cell.held)
    cell.loop.request('cancel')
    cell.run()
    assert cell.results[-1].message == 'canceled by ~/cancel'


def test_what_crosses_a_border_that_is_always_closed_is_refused() -> None:
    cell = Cell(wall(0.4, always=True), closed=None)
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run()
    assert "crosses the border of zone 'press' at" in cell.results[-1].message


def test_before_anything_is_known_borders_are_closed_and_nothing_is_violated() -> None:
    cell = Cell(wall(-0.2), closed=None)  # the robot is across it
    cell.step(50)
    assert not cell.controller.stops.latched
    cell.loop.close_zones(('press',))
    cell.step(2)
    assert cell.stops[-1].fault is Fault.ZONE_VIOLATED


def test_a_tool_that_is_set_counts() -> None:
    zone = wall(0.4)
    cell = Cell(zone)
    assert cell.zones is not None
    cell.zones.set_tool(np.array([0.0, 0.0, 0.3]))
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=cell.held)
    r, T = ROBOT.direct_kinematics(cell.q)
    region = zone.region
    assert isinstance(region, HalfSpace)
    assert 0.0 < region.normal @ (region.point - r - T @ [0.0, 0.0, 0.3]) < 3e-3


def test_what_is_attached_later_counts() -> None:
    zone = Zone('press', wall(0.8).region, 'out', 'bodies', SWITCHED)
    stood = []
    for length in (0.1, 0.6):
        short, held = (
            Scene(attached=(AttachedObject('lance', Capsule(0.01, size), Pose.identity()),), zones=(zone,))
            for size in (0.1, length)
        )
        cell = Cell()
        cell.zones = cell.controller.speed.zones = ZoneGuard(ROBOT, short)
        cell.loop.close_zones(('press',))
        cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
        cell.step(5)
        cell.zones.set_scene(held)
        cell.loop.search_paths()
        cell.run(until=cell.held)
        stood.append(cell.q[0])
    assert stood[1] < stood[0]

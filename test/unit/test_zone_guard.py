"""The controller holds motions and streams before closed borders, and stops a robot that is across one."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from types import MappingProxyType

import numpy as np
import pytest

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.faults import ZONE_VIOLATED
from robots_controller.control.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.shared_zone import ZoneState
from robots_controller.control.speed_control import SpeedControl
from robots_controller.control.stop_latch import StopState
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.control.zone_guard import ZoneGuard
from robots_controller.io.io_image import Channel
from robots_controller.io.zone_inputs import ZoneInputs, closing_inputs, closing_texts, parse_closing
from robots_core import Pose
from robots_core.blocks import HalfSpace, PlacedBox, Zone
from robots_core.blocks.collision.scene import AttachedObject, Scene
from robots_core.errors import InvalidInputError
from robots_core.motion_result import MotionResult
from robots_core.robot_model.shapes import Box, Capsule
from robots_planning import LinearJoint, LinearJointAxes

from .small_arms import small_arm, start_of

PERIOD = 0.004
ROBOT, START = small_arm(3), start_of(3)
SWITCHED = MappingProxyType({'digital_input.1': False})


def turned(angle: float) -> np.ndarray:
    """The start, turned about the vertical by so many radians."""
    return START + np.array([angle, 0.0, 0.0])


def tool(q: np.ndarray) -> np.ndarray:
    return ROBOT.direct_kinematics(q)[0]


def wall(angle: float, *, always: bool = False) -> Zone:
    """Out of the half-space that the tool enters where the start is turned by an angle."""
    r = tool(turned(angle))
    normal = np.array([-r[1], r[0], 0.0])
    return Zone('press', HalfSpace(r, normal), 'out', 'tool', {} if always else SWITCHED)


class Cell:
    """A control loop whose drives are ideal; references are kept."""

    def __init__(
        self, *zones: Zone, limit: float = 0.0, closed: tuple[str, ...] | None = ('press',), name: str = ''
    ) -> None:
        self.zones = ZoneGuard(ROBOT, Scene(zones=zones), name=name) if zones else None
        axes, settings = ROBOT.axes_data, ControllerSettings(period=PERIOD)
        frame_limit = FrameSpeedLimit(ROBOT, limit)
        speed = SpeedControl(axes, settings, frame_limit=frame_limit, zones=self.zones)
        self.controller = Controller(axes, settings, speed=speed)
        self.loop = ControlLoop(self.controller, ControllerRates(1.0 / PERIOD, 0.5), self, progress_every=1)
        self.now, self.q = 0.0, START
        self.references: list[np.ndarray] = []
        self.results: list[MotionResult] = []
        self.stops: list[StopState] = []
        if closed is not None:
            self.loop.close_zones(closed)
        self.step()

    def step(self, times: int = 1) -> None:
        for _ in range(times):
            reference = self.loop.step(self.now, self.q)
            self.loop.report()
            assert reference is not None
            self.now += PERIOD
            self.q = reference[0]
            self.references.append(reference.copy())

    def run(self, until: Callable[[], bool] = lambda: False, longest: float = 20.0) -> None:
        end = self.now + longest
        self.step()
        resting = (ControllerState.HOLDING, ControllerState.STOPPED)
        while not until() and (self.loop.pending or self.controller.state not in resting):
            self.step()
            assert self.now < end

    def held(self) -> bool:
        """The robot stands before a border."""
        return bool(self.controller.obstacle) and not self.references[-1][1].any()

    def clearance(self, zone: Zone) -> float:
        region = zone.region
        assert isinstance(region, HalfSpace)
        return float(region.normal @ (region.point - tool(self.q)))

    def jog(self, velocity: np.ndarray, times: int) -> None:
        for _ in range(times):
            point = StreamPoint(self.q + PERIOD * velocity, velocity, np.zeros(3), self.now + PERIOD)
            self.loop.stream(point, 'jog')
            self.step()

    def result(self, result: MotionResult) -> None:
        self.results.append(result)

    def progress(self, progress: float) -> None:
        """See `ControlPort`."""

    def stream_refused(self, error: Exception, _now: float) -> None:
        raise error

    def stop_changed(self, state: StopState) -> None:
        self.stops.append(state)

    def run_enabled(self, *, enabled: bool) -> None:
        """See `ControlPort`."""


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
    assert cell.stops[-1].fault is ZONE_VIOLATED
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
    assert cell.stops[-1].fault is ZONE_VIOLATED
    assert not cell.stops[-1].drives_on
    cell.loop.reset()
    cell.step(10)
    assert cell.controller.state is ControllerState.HOLDING
    # Not further in:
    cell.loop.follow(LinearJoint(ROBOT).generate(cell.q, turned(1.3)), 'further')
    cell.step(200)
    np.testing.assert_allclose(cell.q, turned(1.0), atol=1e-6)
    cell.loop.request('stop')
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


@pytest.mark.parametrize('speed', [0.05, 0.5, 1.8])
@pytest.mark.parametrize('bend', [0.0, 0.3])
def test_a_stream_brakes_before_a_closed_border(speed: float, bend: float) -> None:
    zone = wall(0.8)
    cell = Cell(zone)
    cell.jog(np.array([speed, bend * speed, -bend * speed]), round(1.6 / speed / PERIOD))
    assert 0.0 < cell.clearance(zone) < 0.01
    assert "'press', which is closed" in cell.controller.obstacle
    velocity = np.array([reference[1] for reference in cell.references])
    assert np.abs(np.diff(velocity, axis=0)).max() <= ROBOT.axes_data.acceleration.max() * PERIOD * 1.001
    cell.jog(np.array([-speed, 0.0, 0.0]), round(0.4 / speed / PERIOD))
    assert cell.clearance(zone) > 0.05
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


def test_a_stopped_program_stops_a_robot_that_waits() -> None:
    cell = Cell(wall(0.4))
    cell.loop.follow(LinearJoint(ROBOT).generate(START, turned(1.2)), 'motion')
    cell.run(until=cell.held)
    cell.loop.request('stop')
    cell.run()
    assert cell.results[-1].message == 'stopped by ~/stop'


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
    assert cell.stops[-1].fault is ZONE_VIOLATED


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
            receiver.loop.hear_zones(sender, states)
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
        cell.loop.change_borders()
        cell.run(until=cell.held)
        stood.append(cell.q[0])
    assert stood[1] < stood[0]


ZONES = (wall(0.1), Zone('other', wall(0.2).region, 'out', 'tool', {'free': False, 'digital_input.3': True}))
SIGNALS = {'free': Channel('digital', 'input', 2, 'free')}


def test_inputs_close_zones_as_the_scene_says() -> None:
    closing = closing_inputs(ZONES, SIGNALS)
    assert closing == {'press': {1: 0}, 'other': {2: 0, 3: 1}}
    for inputs in (ZoneInputs(closing), parse_closing(closing_texts(closing))):
        assert inputs.closed([1, 1, 0]) == frozenset()
        assert inputs.closed([0, 1, 0]) == {'press'}
        assert inputs.closed([1, 0, 0]) == inputs.closed([1, 1, 1]) == {'other'}
        assert inputs.closed([1]) == {'other'}  # of what is not known there is nothing to open it
    assert not parse_closing([''])


@pytest.mark.parametrize(
    ('closed_by', 'reason'),
    [
        ({'press_open': False}, "zone 'x': closed_by: 'press_open' is no channel"),
        ({'digital_output.1': False}, 'digital_output.1 is no digital input'),
        ({'free': False, 'digital_input.2': True}, 'names digital_input.2 twice'),
    ],
)
def test_what_is_no_input_closes_no_zone(closed_by: dict[str, bool], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        closing_inputs([Zone('x', ZONES[0].region, 'out', 'tool', closed_by)], SIGNALS)


@pytest.mark.parametrize(
    'text', ['press', 'digital_input.1=off', 'digital_output.1=off press', 'digital_input.1=0 p']
)
def test_a_parameter_of_another_form_is_refused(text: str) -> None:
    with pytest.raises(InvalidInputError):
        parse_closing([text])

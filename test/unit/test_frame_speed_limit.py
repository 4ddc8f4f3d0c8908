"""The speed limit of tool and frames holds on every motion, and changes on the path."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.streamed_reference import StreamPoint
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError
from robots_planning import LinearCartesianLimited, LinearJoint, LinearJointAxes, Trajectory

PERIOD = 0.004
LIMIT = 0.25  # m/s, as in manual operation
TOOL = np.array([0.1, 0.0, 0.3])
READY = {'kuka_kr210_r2700': np.radians([0.0, -90.0, 90.0, 0.0, 60.0, 0.0])}  # for lines
ROBOTS = ('kuka_kr210_r2700', 'ur5e', 'bello_bot', 'cello_bot', 'debris_arm')


class Cell:
    """A control loop whose drives are ideal; references are kept."""

    def __init__(self, name: str, limit: float, start: np.ndarray | None = None) -> None:
        self.robot = load_robot_model(name)
        self.frame_limit = FrameSpeedLimit(self.robot, limit)
        self.frame_limit.set_tool(TOOL)
        settings = ControllerSettings(period=PERIOD)
        speed = SpeedControl(self.robot.axes_data, settings, frame_limit=self.frame_limit)
        self.controller = Controller(self.robot.axes_data, settings, speed=speed)
        self.loop = ControlLoop(self.controller, ControllerRates(1.0 / PERIOD, 0.5), self, progress_every=1)
        self.now = 0.0
        self.q = self.robot.home if start is None else start
        self.references: list[np.ndarray] = []
        self.failures: list[str] = []
        self.step()

    def step(self) -> None:
        reference = self.loop.step(self.now, self.q)
        self.loop.report()
        assert reference is not None
        self.now += PERIOD
        self.q = reference[0]
        self.references.append(reference[0])

    def run(self, until: Callable[[], bool] = lambda: False, longest: float = 60.0) -> None:
        end = self.now + longest
        self.step()
        while not until() and (self.loop.pending or self.controller.state is not ControllerState.HOLDING):
            self.step()
            assert self.now < end

    def speeds(self) -> np.ndarray:
        """Of the fastest of frames and tool between all references, m/s."""
        places = [frame_places(self.robot, q) for q in self.references]
        return np.array([np.linalg.norm(b - a, axis=1).max() / PERIOD for a, b in pairwise(places)])

    def result(self, result: object) -> None:
        if not getattr(result, 'ok', False):
            self.failures.append(str(result))

    def progress(self, progress: float) -> None:
        """See `ControlPort`."""

    def stream_refused(self, error: Exception, _now: float) -> None:
        raise error

    def run_enabled(self, *, enabled: bool) -> None:
        """See `ControlPort`."""

    def stop_changed(self, state: object) -> None:
        """See `ControlPort`."""


def frame_places(robot: BaseRobotModel, q: np.ndarray) -> np.ndarray:
    r, T = robot.direct_kinematics(q)
    return np.vstack([robot.kinematic_model.frame_axes(q)[0], r, r + T @ TOOL])


def motion(robot: BaseRobotModel, kind: str) -> Trajectory:
    reach = 0.12 * (robot.axes_data.upper - robot.axes_data.lower).clip(max=4.0)
    target = np.clip(robot.home + reach, robot.axes_data.lower, robot.axes_data.upper)
    if kind == 'joint':
        return LinearJoint(robot).generate(robot.home, target)
    if kind == 'axes':
        return LinearJointAxes(robot).generate(robot.home, target)
    start = READY.get(robot.name, robot.home)
    r, T = robot.direct_kinematics(start)
    line = LinearCartesianLimited(robot, cartesian_speed=2.0, cartesian_acceleration=10.0)
    return line.generate(start, Pose(r + np.array([-0.05, 0.1, -0.1]), T))


@pytest.mark.parametrize('kind', ['joint', 'axes'])
@pytest.mark.parametrize('name', ROBOTS)
def test_no_frame_is_faster_on_joint_motions(name: str, kind: str) -> None:
    cell = Cell(name, LIMIT)
    trajectory = motion(cell.robot, kind)
    cell.loop.follow(trajectory, 'motion')
    cell.run()
    assert not cell.failures
    np.testing.assert_allclose(cell.q, trajectory.position[-1], atol=1e-9)
    speeds = cell.speeds()
    assert speeds.max() <= LIMIT
    # The limit is used: most of the way is done near it.
    assert np.sum(speeds[speeds > 0.8 * LIMIT]) > 0.6 * np.sum(speeds)


@pytest.mark.parametrize('peak', [0.04, 0.0425, 0.045, 0.0475])
def test_the_cap_counts_a_peak_of_the_speed_between_two_of_its_nodes(peak: float) -> None:
    robot, rate, length = load_robot_model('ur5e'), 1.0, 0.09
    # The first axis speeds up evenly to the peak, and slows down evenly; nodes of the cap are 0.01 s apart.
    time = np.union1d(np.linspace(0.0, length, 91), [peak])
    motion = np.zeros((3, len(time), 6))
    motion[0] = robot.home
    rising, left = time <= peak, length - time
    motion[0, :, 0] += np.where(
        rising, 0.5 * rate * time**2 / peak, 0.5 * rate * (length - left**2 / (length - peak))
    )
    motion[1, :, 0] = rate * np.minimum(time / peak, left / (length - peak))
    motion[2, :, 0] = np.where(rising, rate / peak, -rate / (length - peak))
    cap = FrameSpeedLimit(robot, LIMIT).cap(Trajectory(time, *motion), robot.axes_data.acceleration, 0.2)
    assert cap is not None
    reach = np.linalg.norm(robot.direct_kinematics(robot.home)[0][:2])
    assert 0.85 * LIMIT < cap.here(peak) * rate * reach <= LIMIT


@pytest.mark.parametrize('name', ['kuka_kr210_r2700', 'ur5e'])
def test_no_frame_is_faster_on_lines(name: str) -> None:
    cell = Cell(name, LIMIT, READY.get(name))
    cell.loop.follow(motion(cell.robot, 'line'), 'motion')
    cell.run()
    assert not cell.failures
    assert cell.speeds().max() <= LIMIT


def test_a_limit_that_no_frame_reaches_changes_nothing() -> None:
    free, limited = Cell('kuka_kr210_r2700', 0.0), Cell('kuka_kr210_r2700', 100.0)
    for cell in (free, limited):
        cell.loop.follow(motion(cell.robot, 'joint'), 'motion')
        cell.run()
    np.testing.assert_array_equal(free.references, limited.references)


def test_it_changes_on_the_path_without_a_stop() -> None:
    cell = Cell('kuka_kr210_r2700', 0.0)
    trajectory = motion(cell.robot, 'joint')
    cell.loop.follow(trajectory, 'motion')
    cell.run(until=lambda: cell.controller.progress > 0.4)
    assert cell.speeds()[-1] > 4.0 * LIMIT

    cell.frame_limit.limit = LIMIT
    cell.loop.search_paths()
    changed = len(cell.references)
    cell.run(until=lambda: cell.controller.progress > 0.6)
    slow = cell.speeds()[changed - 1 :]
    braking = int(np.argmax(slow <= LIMIT))
    assert 0 < braking * PERIOD < 1.0  # from 2.5 m/s at the axes' limits
    assert slow[braking:].max() <= LIMIT
    assert slow.min() > 0.5 * LIMIT

    cell.frame_limit.limit = 0.0
    cell.loop.search_paths()
    cell.run()
    assert cell.speeds().max() > 4.0 * LIMIT
    assert not cell.failures
    on_line = np.array(cell.references) - trajectory.position[0]
    along = on_line @ on_line[-1] / (on_line[-1] @ on_line[-1])
    np.testing.assert_allclose(on_line, along[:, None] * on_line[-1], atol=1e-9)


def test_motions_in_a_row_keep_it() -> None:
    cell = Cell('kuka_kr210_r2700', LIMIT)
    there = motion(cell.robot, 'joint')
    cell.loop.follow(there, 'there')
    cell.loop.follow(LinearJoint(cell.robot).generate(there.position[-1], cell.robot.home), 'back')
    cell.run()
    assert not cell.failures
    np.testing.assert_allclose(cell.q, cell.robot.home, atol=1e-9)
    assert cell.speeds().max() <= LIMIT


def test_motions_that_take_the_place_of_others_keep_it() -> None:
    cell = Cell('kuka_kr210_r2700', LIMIT)
    planner = LinearJoint(cell.robot)
    first = motion(cell.robot, 'joint')
    cell.loop.follow(first, 'first')
    cell.run(until=lambda: cell.controller.progress > 0.2)
    join = round(0.5 * first.duration, 9)
    back = planner.generate_moving(first.sample(join), cell.robot.home)
    cell.loop.follow(back, 'second', join_time=join)
    cell.run()
    np.testing.assert_allclose(cell.q, cell.robot.home, atol=1e-9)
    assert cell.speeds().max() <= LIMIT


@pytest.mark.parametrize('name', ROBOTS)
def test_streams_keep_it(name: str) -> None:
    cell = Cell(name, LIMIT)
    velocity = 0.9 * cell.robot.axes_data.velocity * (-1.0) ** np.arange(cell.robot.num_axes)
    axes, still, position = cell.robot.axes_data, np.zeros(cell.robot.num_axes), cell.robot.home
    for _ in range(250):
        position = np.clip(position + PERIOD * velocity, axes.lower, axes.upper)
        cell.loop.stream(StreamPoint(position, velocity, still, cell.now + PERIOD), 'stream')
        cell.step()
    assert LIMIT * 0.2 < cell.speeds().max() <= LIMIT


@pytest.mark.parametrize('limit', [-0.1, float('nan'), float('inf')])
def test_what_is_no_limit_is_refused(limit: float) -> None:
    with pytest.raises(InvalidInputError, match=r'tool_speed_limit'):
        FrameSpeedLimit(load_robot_model('ur5e'), limit)

"""CollisionGuard: places ahead, objects that come, robots that leave their path or move without one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks import CollisionDetection, JointPath, Scene, SceneObject
from robots_core.blocks.collision.collision_guard import CollisionGuard
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError
from robots_core.robot_model.shapes import Sphere
from robots_core.status import Level

ROBOT = load_robot_model('kuka_kr210_r2700')
DETECTION = CollisionDetection(ROBOT)
STILL = np.zeros(6)


class Stops:
    """Takes the reasons for stopping, and may be out of order."""

    def __init__(self) -> None:
        self.reasons: list[str] = []
        self.works = True

    def __call__(self, reason: str) -> bool:
        self.reasons.append(reason)
        return self.works


@pytest.fixture
def stops() -> Stops:
    return Stops()


@pytest.fixture
def guard(stops: Stops) -> CollisionGuard:
    guard = CollisionGuard(DETECTION, stops)
    guard.set_scene(Scene())
    return guard


def turned(angle: float) -> np.ndarray:
    return np.array(ROBOT.home) + np.array([angle, 0.0, 0.0, 0.0, 0.0, 0.0])


def ball(angle: float, radius: float = 0.1) -> Scene:
    """A ball around tool0 where axis 1 is turned."""
    return Scene(
        (SceneObject('ball', Sphere(radius), Pose(ROBOT.direct_kinematics(turned(angle))[0], np.eye(3))),)
    )


def move(start: float, end: float, duration: float = 10.0) -> JointPath:
    """From rest to rest."""
    position = np.array([turned(start), turned(end)])
    return JointPath(np.array([0.0, duration]), position, 0.0 * position, 0.0 * position)


def test_a_place_on_the_path_stops_the_robot_once_when_it_is_near(guard: CollisionGuard, stops: Stops):
    guard.set_scene(ball(1.0))
    guard.planned('a', move(0.0, 1.2))
    danger = guard.motions['a'].danger
    assert danger is not None
    status = guard.check(turned(0.0), STILL).status
    assert (status.level, status.values['ahead']) == (Level.WARN, danger.describe())
    guard.progress((danger.time - 1.1) / 10.0)
    assert not stops.reasons
    guard.progress((danger.time - 0.9) / 10.0)
    guard.progress((danger.time - 0.8) / 10.0)
    assert stops.reasons == [danger.describe()]
    assert guard.stopping
    assert not guard.ended(MotionResult('a', ok=False, message='', blocked=True))  # may go around
    assert guard.stopping
    assert guard.ended(MotionResult('a', ok=False, message=''))
    assert not guard.stopping


def test_a_robot_that_nothing_can_stop_is_to_be_stopped_again(guard: CollisionGuard, stops: Stops):
    stops.works = False
    guard.set_scene(ball(1.0))
    guard.planned('a', move(0.0, 1.2, 0.8))
    guard.progress(0.1)
    assert len(stops.reasons) == 2
    assert not guard.stopping


def test_a_motion_that_waits_is_at_its_start(guard: CollisionGuard, stops: Stops):
    guard.set_scene(ball(1.0))
    guard.planned('a', move(0.0, 0.1))
    guard.planned('b', move(0.1, 1.2))
    guard.progress(1.0)
    assert not guard.ended(MotionResult('a', ok=True, message='passed'))
    danger = guard.motions['b'].danger
    assert danger is not None
    assert not stops.reasons
    guard.progress((danger.time - 0.5) / 10.0)
    assert len(stops.reasons) == 1


def test_an_object_that_comes_into_the_path_stops_the_motion(guard: CollisionGuard, stops: Stops):
    guard.planned('a', move(0.0, 1.2, 2.0))
    guard.progress(0.3)
    guard.set_scene(ball(0.0, radius=0.02))
    assert guard.motions['a'].danger is None  # behind the robot it does not matter
    guard.set_scene(ball(0.9))
    assert len(stops.reasons) == 1


def test_a_robot_that_leaves_its_path_is_stopped(guard: CollisionGuard, stops: Stops):
    guard.set_scene(ball(1.0))
    guard.planned('a', move(0.0, -0.5, 2.0))
    guard.check(turned(0.0), STILL)
    assert not stops.reasons
    assert guard.check(turned(1.0), STILL).status.level is Level.ERROR
    assert len(stops.reasons) == 1


def test_a_robot_without_a_path_is_stopped_while_it_can_brake(guard: CollisionGuard, stops: Stops):
    guard.set_scene(ball(1.0))
    jogging = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    guard.check(turned(0.3), jogging)
    near = next(turned(a) for a in np.arange(0.3, 1.0, 0.01) if guard.check(turned(a), STILL).distance < 0.03)
    guard.check(near, -jogging)
    guard.check(near, None)
    assert not stops.reasons  # far away, leaving, or not known to move
    guard.check(near, jogging)
    assert len(stops.reasons) == 1
    assert guard.stopping
    guard.check(near, -jogging)
    assert not guard.stopping


@pytest.mark.parametrize(('distance', 'stopped'), [(0.0015, 1), (0.0, 0)])  # contact has no direction
def test_a_robot_that_is_too_close_may_be_jogged_away(
    guard: CollisionGuard, stops: Stops, distance: float, stopped: int
):
    guard.set_scene(ball(1.0))
    slow = np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])
    angles = np.arange(0.3, 1.0, 1e-4)
    near = next(turned(a) for a in angles if guard.check(turned(a), STILL).distance <= distance)
    guard.check(near, -slow)  # away
    assert not stops.reasons
    guard.check(near, slow)
    assert len(stops.reasons) == stopped


@pytest.mark.parametrize('radius', [0.1, 0.02])
def test_an_object_that_comes_into_contact_with_a_guided_robot_stops_it(
    guard: CollisionGuard, stops: Stops, radius: float
):
    guard.check(turned(0.5), STILL)
    guard.set_scene(ball(0.5, radius))
    guard.check(turned(0.5), np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert len(stops.reasons) == 1
    guard.check(turned(0.5), STILL)  # from here on it may be led away
    guard.check(turned(0.5), np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert len(stops.reasons) == 1


def test_a_new_scene_is_looked_at_where_the_robot_stands(guard: CollisionGuard, stops: Stops):
    before = guard.check(turned(0.0), STILL)
    guard.set_scene(ball(0.0))
    inside = guard.check(turned(0.0), STILL)
    assert before.distance > inside.distance == 0.0
    assert 'link_6/flange - ball' in str(inside.status.values['contacts'])
    assert not stops.reasons  # a robot that stands


@pytest.mark.parametrize(
    ('time', 'position', 'velocity', 'reason'),
    [
        pytest.param(10.0, 1e6, 0.0, 'outside its limits', id='far beyond the limits'),
        pytest.param(10.0, 0.0, 1e4, 'its limit is', id='far beyond them between its points'),
        pytest.param(1e-6, 0.5, 0.0, 'its limit is', id='in no time'),
        pytest.param(1e9, 0.5, 0.0, 'allowed are 3600 s', id='for years'),
        pytest.param(10.0, 1e308, 0.0, 'no number within', id='huge'),
        pytest.param(10.0, 0.0, np.nan, 'no number within', id='NaN'),
    ],
)
def test_paths_that_no_controller_follows_are_refused(
    guard: CollisionGuard, time: float, position: float, velocity: float, reason: str
):
    points = np.array([turned(0.0), turned(position)])
    velocities = np.zeros_like(points)
    velocities[:, 0] = velocity
    with pytest.raises(InvalidInputError, match=reason):
        guard.planned('a', JointPath(np.array([0.0, time]), points, velocities, np.zeros_like(points)))
    assert not guard.motions


def test_measured_velocities_that_no_robot_has_are_looked_at_as_its_limits(
    guard: CollisionGuard, stops: Stops
):
    guard.set_scene(ball(1.0))
    guard.check(turned(0.5), np.full(6, 1e300))
    guard.check(turned(0.5), np.array([1e6, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert 'ball' in stops.reasons[-1]


def test_bad_values_are_refused(guard: CollisionGuard, stops: Stops):
    bad: Any = np.full(6, np.nan)
    for q, q_dot in ((bad, None), (turned(0.0), bad)):
        with pytest.raises(InvalidInputError):
            guard.check(q, q_dot)
    with pytest.raises(InvalidInputError, match='margin'):
        CollisionGuard(DETECTION, stops, margin=-1.0)

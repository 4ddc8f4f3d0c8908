"""CollisionDetection: names, scenes, what is left out, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import (
    AttachedObject,
    CollisionDetection,
    CollisionError,
    JointPath,
    PathProximity,
    Proximity,
    Scene,
    SceneObject,
)
from robots_core.errors import InvalidInputError, PlanningError
from robots_core.robot_model.shapes import Box, Mesh, Sphere
from robots_core.robot_model.urdf.triangle_mesh import triangle_mesh
from robots_planning import PathPlanning
from robots_planning.motion_kinds import JOINT


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


def ball(robot: BaseRobotModel, q: np.ndarray, radius: float = 0.1) -> SceneObject:
    return SceneObject('ball', Sphere(radius), Pose(robot.direct_kinematics(q)[0], np.eye(3)))


def turned(robot: BaseRobotModel, angle: float) -> np.ndarray:
    q = robot.home.copy()
    q[0] += angle
    return q


def test_a_ball_at_the_flange_touches_it(robot: BaseRobotModel):
    detection = CollisionDetection(robot, scene=Scene((ball(robot, robot.home),)))
    assert ('link_6/flange', 'ball') in detection.contacts(robot.home)
    assert detection.in_contact(robot.home)
    found = detection.distance(robot.home)
    assert found is not None
    assert found.in_contact
    assert found.distance == 0.0
    assert not detection.in_contact(turned(robot, 1.0))


@pytest.mark.parametrize('engine', ['fcl', 'coal'])
@pytest.mark.parametrize('around', [(), (SceneObject('ball', Sphere(0.1), Pose.identity()),)])
def test_a_robot_without_shapes_meets_nothing(tmp_path: Path, engine: str, around: tuple[SceneObject, ...]):
    file = tmp_path / 'bare.urdf'
    file.write_text(
        '<robot name="bare"><link name="base"/><link name="arm"/>'
        '<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>'
        '<limit velocity="1" effort="1"/></joint></robot>'
    )
    robot = load_robot_model(f'urdf:{file}')
    detection = CollisionDetection(robot, scene=Scene(around), engine=engine)
    assert detection.contacts(robot.home) == ()
    assert detection.distance(robot.home) is None
    straight = JointPath.straight(robot.home, robot.home + 1.0)
    assert detection.first_approach(straight) is None
    assert detection.closest_approach(straight) is None
    detection.check(straight)


def test_distance_to_a_ball_is_that_of_geometry(robot: BaseRobotModel):
    """A ball on the line of the last axis: the flange's plane is 0.3 m before its surface."""
    r, T = robot.direct_kinematics(robot.home)
    centre = SceneObject('ball', Sphere(0.2), Pose(r + 0.5 * T[:, 2], np.eye(3)))
    detection = CollisionDetection(robot, scene=Scene((centre,)))
    near = {(item.first, item.second): item for item in detection.distances(robot.home, 0.4)}
    shape = next(shape for shape in robot.collision_model.shapes if shape.name == 'link_6/flange')
    frames = robot.kinematic_model.frame_axes(robot.home)
    mesh = triangle_mesh(shape.geometry)
    placed = frames[0][-1] + (shape.pose.r + mesh.vertices @ shape.pose.T.T) @ frames[1][-1].T
    front = ((placed - r) @ T[:, 2]).max()
    # Meshes are drawn in single precision.
    assert near['link_6/flange', 'ball'].distance == pytest.approx(0.3 - front, abs=1e-5)


def test_a_body_inside_of_a_closed_surface_is_in_contact(robot: BaseRobotModel):
    """A concave tank around the flange, far from its walls."""
    r, _ = robot.direct_kinematics(robot.home)
    mesh = triangle_mesh(Box((3.0, 3.0, 3.0)))
    sides = mesh.faces[mesh.face_normals[:, 2] < 0.9]
    corners = np.flatnonzero(mesh.vertices[:, 2] > 0.0)
    corners = corners[np.argsort(np.arctan2(mesh.vertices[corners, 1], mesh.vertices[corners, 0]))]
    dent = [[a, b, 8] for a, b in zip(corners, np.roll(corners, -1), strict=True)]
    vertices, faces = np.vstack([mesh.vertices, [[0.0, 0.0, 1.4]]]), np.vstack([sides, dent])
    tank = SceneObject('tank', Mesh(vertices, faces), Pose(r + np.array([0.9, 0.0, 0.0]), np.eye(3)))
    detection = CollisionDetection(robot, scene=Scene((tank,)))
    assert ('link_6/flange', 'tank') in detection.contacts(robot.home)


def test_who_may_touch_is_not_checked(robot: BaseRobotModel):
    obstacle = ball(robot, robot.home)
    free = Scene((obstacle,), may_touch=frozenset({('ball', 'link_6'), ('link_5/hand', 'ball')}))
    names = CollisionDetection(robot, scene=free).contacts(robot.home)
    assert not [pair for pair in names if 'ball' in pair and pair[0].startswith(('link_5', 'link_6'))]
    with pytest.raises(InvalidInputError, match=r"'gripper'.*there are.*link_6"):
        CollisionDetection(robot, scene=Scene((obstacle,), may_touch=frozenset({('ball', 'gripper')})))


def test_what_hangs_on_the_flange_moves_with_it_and_stays_clear_of_the_wrist(robot: BaseRobotModel):
    stick = AttachedObject('stick', Box((0.02, 0.02, 0.5)), Pose(np.array([0.0, 0.0, 0.25]), np.eye(3)))
    tip = Pose(*robot.direct_kinematics(robot.home)) @ Pose(np.array([0.0, 0.0, 0.6]), np.eye(3))
    obstacle = SceneObject('ball', Sphere(0.11), tip)
    detection = CollisionDetection(robot, scene=Scene((obstacle,), (stick,)))
    assert detection.contacts(robot.home) == (('stick', 'ball'),)
    assert CollisionDetection(robot, scene=Scene((obstacle,))).contacts(robot.home) == ()
    # 5 cm of nearest robot would be the wrist that carries it.
    assert all('link_6' not in item.second for item in detection.distances(robot.home, 0.1))


def test_the_base_may_stand_on_the_floor(robot: BaseRobotModel):
    floor = SceneObject('floor', Box((4.0, 4.0, 0.2)), Pose(np.array([0.0, 0.0, -0.09]), np.eye(3)))
    assert CollisionDetection(robot, scene=Scene((floor,))).contacts(robot.home) == ()


def test_a_colliding_motion_is_refused_with_bodies_and_place(robot: BaseRobotModel):
    collision = CollisionDetection(robot, scene=Scene((ball(robot, turned(robot, 0.6)),)))
    planning = PathPlanning(robot, collision=collision, collision_margin=0.01)
    target = turned(robot, 1.2)
    with pytest.raises(CollisionError, match=r'ball after .* % of the path .*; the margin is 10 mm') as info:
        planning.plan(JOINT, robot.home, target)
    assert isinstance(info.value, PlanningError)
    details = info.value.details
    assert details['obstacle'] == 'ball'
    place = info.value.place
    assert details['percent'] == 100.0 * place.fraction
    assert details['margin'] == 0.01
    np.testing.assert_allclose([details[name] for name in 'xyz'], robot.direct_kinematics(place.q)[0])
    assert 0.0 < place.q[0] < 0.6  # before the ball
    near = collision.distance(place.q)
    assert near is not None
    assert near.distance == pytest.approx(0.01, abs=1e-3)
    free = planning.plan(JOINT, robot.home, turned(robot, -1.2))
    closest = collision.closest_approach(
        JointPath(
            free.trajectory.time,
            free.trajectory.position,
            free.trajectory.velocity,
            free.trajectory.acceleration,
        )
    )
    assert closest is not None
    assert closest.proximity.distance > 0.01


def test_what_is_too_close_at_the_start_may_leave_but_not_come_closer(robot: BaseRobotModel):
    r, _ = robot.direct_kinematics(robot.home)
    beside = SceneObject('ball', Sphere(0.1), Pose(r + np.array([0.0, 0.24, 0.0]), np.eye(3)))
    detection = CollisionDetection(robot, scene=Scene((beside,)))
    start = detection.distance(robot.home)
    assert start is not None
    assert 0.0 < start.distance < 0.1
    leave, approach = (JointPath.straight(robot.home, turned(robot, angle)) for angle in (0.5, -0.01))
    # Axis 1 of a KUKA turns clockwise: a positive angle leads away from +y.
    assert detection.first_approach(leave, margin=0.1) is None
    place = detection.first_approach(approach, margin=0.1)
    assert place is not None
    assert place.proximity.second == 'ball'
    assert detection.first_approach(approach, margin=0.0) is None


def test_a_start_in_contact_is_refused_at_once(robot: BaseRobotModel):
    detection = CollisionDetection(robot, scene=Scene((ball(robot, robot.home),)))
    place = detection.first_approach(JointPath.straight(robot.home, turned(robot, 1.0)))
    assert place is not None
    assert (place.time, place.fraction) == (0.0, 0.0)
    assert place.proximity.in_contact


@pytest.mark.parametrize('value', [np.nan, np.inf])
def test_bad_input_is_refused(robot: BaseRobotModel, value: float):
    detection = CollisionDetection(robot)
    q = robot.home.copy()
    q[2] = value
    for call in (detection.distance, detection.contacts, detection.in_contact):
        with pytest.raises(InvalidInputError, match=r'q\[2\]'):
            call(q)
    with pytest.raises(InvalidInputError, match='shape'):
        detection.distance(robot.home[:3])
    path = JointPath.straight(robot.home, turned(robot, 0.1))
    for margin in (value, -0.1):
        with pytest.raises(InvalidInputError, match='margin'):
            detection.first_approach(path, margin=margin)
        with pytest.raises(InvalidInputError, match='margin'):
            PathPlanning(robot, collision=detection, collision_margin=margin)
    with pytest.raises(InvalidInputError, match='tolerance'):
        detection.closest_approach(path, tolerance=0.0)
    with pytest.raises(InvalidInputError, match='3 axes'):
        detection.first_approach(JointPath.straight(np.zeros(3), np.ones(3)))
    with pytest.raises(InvalidInputError, match="'ode' is unknown; valid are fcl and coal"):
        CollisionDetection(robot, engine='ode')
    with pytest.raises(InvalidInputError, match='no number within'):
        JointPath.straight(robot.home, q)
    with pytest.raises(InvalidInputError, match='has the name of a link'):
        detection.set_scene(Scene((SceneObject('link_3', Sphere(0.1), Pose.identity()),)))
    with pytest.raises(InvalidInputError, match='two objects'):
        Scene((ball(robot, robot.home), ball(robot, robot.home)))


def test_a_distance_that_is_only_maybe_below_the_margin_says_so():
    point = np.zeros(3)
    near = Proximity('hand/flange', 'post', 0.00506, point, point)
    place = PathProximity(1.0, 0.5, point, Pose.identity(), near)
    assert 'hand/flange comes to 5.1 mm from post' in str(CollisionError(place, 0.005))
    assert str(CollisionError(place, 0.005)).endswith('and may come 0.1 mm closer; the margin is 5 mm')
    just_below = replace(place, proximity=replace(near, distance=0.00498))
    assert 'comes to 4.98 mm from post after' in str(CollisionError(just_below, 0.005))
    assert str(CollisionError(place, 0.006)).endswith('the margin is 6 mm')
    contact = replace(place, proximity=replace(near, distance=0.0))
    assert 'margin' not in str(CollisionError(contact, 0.005))

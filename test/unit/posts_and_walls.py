"""A KUKA KR 210 around which a post or walls stand."""

from __future__ import annotations

from functools import cache

import numpy as np

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import AttachedObject, CollisionDetection, JointPath, Scene, SceneObject
from robots_core.robot_model.shapes import Box, Capsule, Geometry
from robots_planning import CollisionFreeJoint, Trajectory

MARGIN = 0.005  # m
FINE = 0.01  # s, between postures of the dense check
START = np.radians([-30.0, -70.0, 90.0, 0.0, 70.0, 0.0])
SIDES = np.radians([[side, -70.0, 90.0, 0.0, 70.0, 0.0] for side in (-70.0, 70.0)])
TARGET = np.radians([30.0, -70.0, 90.0, 0.0, 70.0, 0.0])


@cache
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


def item(name: str, geometry: Geometry, *position: float) -> SceneObject:
    return SceneObject(name, geometry, Pose(np.array(position), np.eye(3)))


POST = item('post', Capsule(0.05, 1.6), 1.7, 0.0, 1.0)


def detection_of(*objects: SceneObject, attached: tuple[AttachedObject, ...] = ()) -> CollisionDetection:
    return CollisionDetection(robot(), scene=Scene(objects, attached))


@cache
def around_post() -> CollisionDetection:
    return detection_of(POST)


@cache
def divided_room() -> CollisionDetection:
    """Start and target on the two sides of walls that leave nothing but the robot's column free."""
    front, back = (
        item(name, Box((4.2, 0.05, 5.0)), x, 0.0, 0.0) for name, x in (('front', 2.7), ('back', -2.7))
    )
    return detection_of(front, back, item('roof', Box((6.0, 6.0, 0.1)), 0.0, 0.0, 2.5))


def planner(collision: CollisionDetection | None, **options: object) -> CollisionFreeJoint:
    return CollisionFreeJoint(robot(), collision=collision, **{'margin': MARGIN} | options)  # type: ignore[arg-type]


def check_free(collision: CollisionDetection, trajectory: Trajectory, margin: float = MARGIN) -> None:
    """No posture comes closer, by distances that are computed one by one."""
    times = np.arange(0.0, trajectory.duration, FINE)
    for q in trajectory.sample(times)[0]:
        closest = collision.distance(q)
        assert closest is None or closest.distance >= margin
    path = JointPath(trajectory.time, trajectory.position, trajectory.velocity, trajectory.acceleration)
    assert collision.first_approach(path, margin=margin) is None

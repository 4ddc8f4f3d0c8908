"""CollisionFreeJoint: what is said where there is no way, and when a search is given up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks import AttachedObject, CollisionDetection, JointPath, Scene
from robots_core.blocks.collision.results import CollisionError
from robots_core.errors import JointLimitError, PlanningError
from robots_core.robot_model.shapes import Box, Capsule, Sphere
from robots_planning import CollisionFreeJoint, MotionSettings, PathPlanning
from robots_planning.free_paths import free_path_search
from robots_planning.free_paths.errors import BlockedPostureError, NoFreePathError, SearchCancelledError
from robots_planning.free_paths.free_path_search import SLICE, FreePathSearch
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, LINE

from .posts_and_walls import (
    MARGIN,
    POST,
    SIDES,
    START,
    TARGET,
    around_post,
    check_free,
    detection_of,
    divided_room,
    item,
    planner,
    robot,
)
from .small_arms import name_of


def test_a_start_in_contact_is_refused_with_the_jog_that_leaves_it():
    r, _ = robot().direct_kinematics(START)
    collision = detection_of(item('ball', Sphere(0.05), *r))
    with pytest.raises(
        BlockedPostureError, match=r'the start collides: link_\d/\w+ meets ball; jog'
    ) as caught:
        planner(collision).generate(START, TARGET)
    words = caught.value.message.split('jog ')[1].split()
    axis, way = robot().axes_data.names.index(words[0]), float(words[2])
    q = START.copy()
    q[axis] += way
    assert not collision.in_contact(q)


def test_a_start_within_the_margin_is_left():
    r, T = robot().direct_kinematics(START)
    ball = item('ball', Sphere(0.05), *(r + T @ [0.0, 0.0, 0.1]))
    collision = detection_of(ball)
    closest = collision.distance(START)
    assert closest is not None
    margin = closest.distance + 0.01
    trajectory = planner(collision, margin=margin).generate(START, START + 0.3 * np.eye(6)[0])
    assert trajectory.duration > 0.0


def test_a_target_that_collides_or_is_too_close_is_refused():
    r, _ = robot().direct_kinematics(TARGET)
    with pytest.raises(BlockedPostureError, match=r'the target collides: .* meets ball'):
        planner(detection_of(item('ball', Sphere(0.05), *r))).generate(START, TARGET)
    r, T = robot().direct_kinematics(TARGET)
    collision = detection_of(item('ball', Sphere(0.05), *(r + T @ [0.0, 0.0, 0.1])))
    closest = collision.distance(TARGET)
    assert closest is not None
    margin = closest.distance + 0.01
    with pytest.raises(
        BlockedPostureError, match=rf'the target is too close: .*the margin is {1e3 * margin:g}'
    ):
        planner(collision, margin=margin).generate(START, TARGET)


def test_a_pose_whose_postures_all_collide_is_refused_with_their_number():
    pose = Pose(*robot().direct_kinematics(TARGET))
    collision = detection_of(item('ball', Sphere(0.05), *pose.r))
    with pytest.raises(BlockedPostureError, match=r'none of \d+ postures that reach the target is free'):
        planner(collision).generate(START, pose)


def test_a_search_without_an_end_is_refused_with_what_blocks_it():
    with pytest.raises(
        NoFreePathError, match=r'budget of 0\.05 s: .* come within .* rad of .* by (front|back|roof)'
    ):
        planner(divided_room(), budget=0.05).generate(*SIDES)


def test_a_posture_outside_the_limits_is_refused():
    with pytest.raises(JointLimitError):
        planner(around_post()).generate(START, [7.0, *TARGET[1:]])


def test_a_tool_larger_than_the_robot_is_planned_with():
    pole = AttachedObject('pole', Capsule(0.02, 3.0), Pose(np.array([0.0, 0.0, 1.5]), np.eye(3)))
    collision = CollisionDetection(robot(), scene=Scene((POST,), (pole,)))
    check_free(collision, planner(collision).generate(START, TARGET))


def test_a_robot_without_collision_shapes_cannot_avoid_what_is_there():
    arm = load_robot_model(name_of(3))
    collision = CollisionDetection(arm, scene=Scene((POST,)))
    with pytest.raises(PlanningError, match='has no collision shapes, so that it can avoid nothing'):
        CollisionFreeJoint(arm, collision=collision).generate(arm.home, arm.home + 0.2)
    rod = AttachedObject('rod', Capsule(0.02, 0.2), Pose(np.array([0.0, 0.0, 0.2]), np.eye(3)))
    held = CollisionDetection(arm, scene=Scene((POST,), (rod,)))
    assert CollisionFreeJoint(arm, collision=held).generate(arm.home, arm.home + 0.2).duration > 0.0


def test_a_start_that_no_jog_leaves_says_so():
    r, _ = robot().direct_kinematics(START)
    with pytest.raises(BlockedPostureError, match=r'the start collides: .* meets .*no jog of one axis by up'):
        planner(detection_of(item('block', Box((9.0, 9.0, 9.0)), *r))).generate(START, TARGET)


def test_a_margin_larger_than_the_free_space_is_refused_with_both():
    """Between two plates, at whose middle the flange cannot be any farther from them."""
    r, _ = robot().direct_kinematics(TARGET)
    plates = (item(f'plate_{z:g}', Box((0.4, 0.4, 0.02)), r[0], r[1], r[2] + z) for z in (-0.45, 0.45))
    collision = detection_of(*plates)
    closest = collision.distance(TARGET)
    assert closest is not None
    planner(collision, margin=0.5 * closest.distance).generate(START, TARGET)
    with pytest.raises(BlockedPostureError, match=r'the target is too close: .* the margin is 500 mm'):
        planner(collision, margin=0.5).generate(START, TARGET)


def test_a_plan_is_given_up_as_soon_as_it_is_cancelled():
    planning = PathPlanning(robot(), collision=divided_room(), collision_margin=MARGIN)
    planning.cancelled = lambda: True
    with pytest.raises(SearchCancelledError):
        planning.plan(JOINT, *SIDES, MotionSettings(avoid=True, avoid_budget=60.0))


def test_a_search_is_given_up_within_a_few_hundred_postures():
    asked: list[int] = []

    def cancelled() -> bool:
        asked.append(int(certificate.work[0]))
        return len(asked) > 1

    search = FreePathSearch(divided_room(), margin=MARGIN, budget=10.0)
    certificate = divided_room().certificate(SIDES[0], margin=MARGIN)
    with pytest.raises(SearchCancelledError):
        search.path(SIDES[0], SIDES[1:], cancelled)
    deepest_edge = 4000  # postures of one edge that grazes something
    assert certificate.work[0] < SLICE + deepest_edge


def test_postures_among_many_bodies_count_as_several(monkeypatch: pytest.MonkeyPatch):
    """So that neither the budget nor a cancellation takes longer there."""
    certificate = divided_room().certificate(SIDES[0], margin=MARGIN)

    def looked_at(pairs: int) -> tuple[int, int]:
        monkeypatch.setattr(free_path_search, 'PAIRS', pairs)
        asked: list[None] = []
        search = FreePathSearch(divided_room(), margin=MARGIN, budget=0.2)
        with pytest.raises(NoFreePathError):
            search.path(SIDES[0], SIDES[1:], lambda: bool(asked.append(None)))
        return int(certificate.work[0]), len(asked)

    few, asked = looked_at(certificate.margins.size)
    many, asked_many = looked_at(certificate.margins.size // 4)
    assert many < 0.5 * few
    assert asked == pytest.approx(asked_many, abs=2)


def test_two_thousand_bodies_are_a_scene():
    rng = np.random.default_rng(3)
    grid = [
        item(f'stone_{k}', Box((0.05, 0.05, 0.05)), *at)
        for k, at in enumerate(rng.uniform([-2.5, -2.5, -1.0], [2.5, 2.5, -0.5], (2000, 3)))
    ]
    collision = detection_of(POST, *grid)
    check = planner(collision).generate(START, TARGET)
    path = JointPath(check.time, check.position, check.velocity, check.acceleration)
    assert collision.first_approach(path, margin=MARGIN) is None


def test_lines_that_collide_are_refused_with_the_motion_that_does_not():
    planning = PathPlanning(robot(), collision=around_post(), collision_margin=MARGIN)
    pose = Pose(*robot().direct_kinematics(TARGET))
    with pytest.raises(CollisionError) as plain:
        planning.plan(LINE, START, pose)
    with pytest.raises(CollisionError, match=r'ptpJointSpacePosition leads there around it in \d') as caught:
        planning.plan(LINE, START, pose, MotionSettings(avoid=True))
    assert caught.value.message.startswith(plain.value.message)
    assert caught.value.details == plain.value.details
    duration = float(caught.value.message.split(' in ')[-1].split(' s')[0])
    motion = planning.plan(JOINT_TO_POSE, START, pose, MotionSettings(avoid=True))
    assert math.isclose(motion.duration, duration, abs_tol=0.005)

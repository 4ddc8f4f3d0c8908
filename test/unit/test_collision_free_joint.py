"""CollisionFreeJoint: free paths around obstacles."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks import AttachedObject, CollisionDetection, JointPath, Scene
from robots_core.blocks.collision.along_paths.path_certificate import FREE
from robots_core.errors import InvalidInputError
from robots_core.robot_model.shapes import Box, Capsule, Mesh, Sphere
from robots_planning import CollisionFreeJoint, MotionSettings, PathPlanning
from robots_planning.free_paths import free_path_search
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, LINE

from .posts_and_walls import (
    MARGIN,
    POST,
    START,
    TARGET,
    around_post,
    check_free,
    detection_of,
    item,
    planner,
    robot,
)

ELSEWHERE = np.array(
    [
        [
            -0.5015556969249263,
            -1.2272862864390288,
            1.5480356457689621,
            0.013362937960892348,
            1.21310282568175,
            -0.018538609889648016,
        ],
        [
            -0.06770607196796481,
            -1.3873838869104957,
            1.1882014450513958,
            0.2642914610454153,
            1.080263776140811,
            -0.2476361603743685,
        ],
        [
            0.3971695111333187,
            -1.2745665597375186,
            1.3646653456434974,
            0.5384154248412718,
            1.203508285415686,
            -0.08879833377290497,
        ],
    ]
)


def test_the_motion_goes_around_without_a_stop_and_keeps_all_limits():
    collision = around_post()
    straight = JointPath.straight(START, TARGET)
    assert collision.first_approach(straight, margin=MARGIN) is not None
    planning = PathPlanning(robot(), collision=collision, collision_margin=MARGIN)
    motion = planning.plan(JOINT, START, TARGET, MotionSettings(avoid=True))
    check_free(collision, motion.trajectory)
    np.testing.assert_array_equal(motion.trajectory.position[[0, -1]], [START, TARGET])
    assert motion.report.ok
    assert 'torque' in motion.report.uses
    speed = np.abs(motion.trajectory.velocity[1:-1] / robot().axes_data.velocity).max(axis=1)
    assert speed.min() > 0.0


def test_a_free_line_is_the_path():
    path = planner(around_post()).joint_path(START, START + 0.1)
    middle, _, _ = path.evaluate(np.array([0.5]))
    np.testing.assert_allclose(middle[0], START + 0.05, atol=1e-15)
    assert len(path.s) == 2


def test_the_same_motion_is_the_same_to_the_bit_and_another_seed_finds_another():
    first, again = (planner(detection_of(POST)).joint_path(START, TARGET) for _ in range(2))
    for one, other in zip(first.samples, again.samples, strict=True):
        np.testing.assert_array_equal(one, other)
    other = planner(around_post(), seed=1).joint_path(START, TARGET)
    assert not np.array_equal(first.q, other.q)


def test_a_way_is_the_same_to_the_bit_on_every_machine():
    generator = planner(detection_of(POST), seed=2)
    generator.joint_path(START, TARGET)
    np.testing.assert_array_equal(generator.via, ELSEWHERE)


def test_random_numbers_are_those_that_are_published():
    """Of splitmix64 from 1234567 (Vigna's reference program), as parts of 2^53."""
    from robots_planning.free_paths.search_kernel import uniform  # noqa: PLC0415

    state = np.array([1234567], dtype=np.uint64)
    expected = (6457827717110365317, 3203168211198807973, 9817491932198370423)
    assert [uniform(state) for _ in expected] == [(value >> 11) * 2.0**-53 for value in expected]


def test_the_duration_that_ways_are_compared_by_is_about_that_of_their_motions():
    from robots_planning.free_paths.search_kernel import duration  # noqa: PLC0415

    axes = robot().axes_data
    limits = np.array([axes.lower, axes.upper, axes.velocity, axes.acceleration])
    assert math.isclose(
        duration(limits, np.array([START, TARGET])),
        planner(None).generate(START, TARGET).duration,
        rel_tol=0.02,
    )
    for seed in range(5):
        generator = planner(around_post(), seed=seed)
        motion = generator.generate(START, TARGET)
        assert generator.via is not None
        estimate = duration(limits, np.array([START, *generator.via, TARGET]))
        assert 0.8 < estimate / motion.duration < 1.1


def mean_duration() -> float:
    """Of the motions around the post with ten seeds, s."""
    return float(
        np.mean([planner(around_post(), seed=k).generate(START, TARGET).duration for k in range(10)])
    )


def test_changes_of_a_way_make_its_motion_faster(monkeypatch: pytest.MonkeyPatch):
    changed = mean_duration()
    for changes in ('FIRST_CHANGES', 'CHANGES'):
        monkeypatch.setattr(free_path_search, changes, (0, 0))
    assert changed < 0.9 * mean_duration()


def test_a_second_search_finds_faster_motions_than_a_detour(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(free_path_search, 'DETOUR', 1.0)
    searched_again = mean_duration()
    monkeypatch.setattr(free_path_search, 'SECOND_SEARCH', 0)  # which finds nothing
    in_vain = mean_duration()
    monkeypatch.setattr(free_path_search, 'DETOUR', np.inf)
    np.testing.assert_equal(mean_duration(), in_vain)
    assert searched_again < in_vain


def test_jerk_limits_are_kept_on_request():
    generator = planner(around_post(), jerk_limited=True)
    trajectory = generator.generate(START, TARGET)
    check_free(around_post(), trajectory)
    times = np.linspace(0.0, trajectory.duration, 4000)
    acceleration = trajectory.sample(times)[2]
    jerk = np.abs(np.diff(acceleration, axis=0) / np.diff(times)[:, None]).max(axis=0)
    assert (jerk <= robot().axes_data.jerk).all()


@pytest.mark.parametrize(('name', 'axis', 'lean'), [('ur5e', 2, 0.6), ('franka_fr3', 3, -0.3)])
def test_a_pose_is_reached_in_another_posture_where_the_nearest_collides(name: str, axis: int, lean: float):
    arm = load_robot_model(name)
    first, second = np.eye(arm.num_axes)[:2]
    start = arm.home + lean * second
    pose = Pose(*arm.direct_kinematics(start + 1.2 * first))
    nearest = CollisionFreeJoint(arm).goal(start, pose)
    # A ball at the elbow of the nearest posture; others have theirs elsewhere.
    elbow = arm.kinematic_model.frame_axes(nearest)[0][axis]
    ball = item('ball', Sphere(0.03), *elbow)
    collision = CollisionDetection(arm, scene=Scene((ball,)))
    assert collision.in_contact(nearest)
    trajectory = CollisionFreeJoint(arm, collision=collision, margin=MARGIN).generate(start, pose)
    end = trajectory.position[-1]
    assert np.abs(end - nearest).max() > 0.1
    reached = Pose(*arm.direct_kinematics(end)).distance_to(pose)
    assert max(reached) < 1e-8
    check_free(collision, trajectory)


def test_tool_and_workpiece_count_and_a_changed_scene_too():
    planning = PathPlanning(robot(), collision=detection_of(), collision_margin=MARGIN)
    settings = MotionSettings(avoid=True)
    free = planning.plan(JOINT, START, TARGET, settings)
    assert planning.collision is not None
    planning.collision.set_scene(Scene((POST,)))
    around = planning.plan(JOINT, START, TARGET, settings)
    rod = AttachedObject('rod', Capsule(0.02, 0.6), Pose(np.array([0.0, 0.0, 0.3]), np.eye(3)))
    planning.collision.set_scene(Scene((POST,), (rod,)))
    with_rod = planning.plan(JOINT, START, TARGET, settings)
    assert free.duration < around.duration
    check_free(planning.collision, with_rod.trajectory)


def test_limits_that_change_hold_for_the_next_motion_on_the_same_path():
    planning = PathPlanning(robot(), collision=around_post(), collision_margin=MARGIN)
    fast = planning.plan(JOINT, START, TARGET, MotionSettings(avoid=True))
    slow = planning.plan(JOINT, START, TARGET, MotionSettings(avoid=True, speed_fraction=0.2))
    assert slow.duration > fast.duration
    limit = 0.2 * robot().axes_data.velocity
    assert (np.abs(slow.trajectory.velocity) <= limit).all()


def test_a_robot_without_anything_around_it_or_without_shapes_takes_its_line():
    straight = planner(None).generate(START, TARGET)
    bare = CollisionDetection(robot(), scene=Scene(), allowed_pairs=None)
    np.testing.assert_array_equal(straight.position, planner(bare).generate(START, TARGET).position)
    still = planner(bare).generate(START, START)
    np.testing.assert_array_equal(still.position, [START, START])


def test_a_thin_sheet_is_not_missed():
    """A tenth of a millimetre: between samples of any check that is not certified."""
    sheet = item('sheet', Box((0.6, 1e-4, 1.2)), 1.7, 0.0, 1.2)
    collision = detection_of(sheet)
    assert collision.first_approach(JointPath.straight(START, TARGET)) is not None
    check_free(collision, planner(collision).generate(START, TARGET))


def test_certificates_agree_with_the_check_of_paths():
    shapes = (
        item('box', Box((0.4, 0.4, 0.4)), 1.5, 0.5, 1.0),
        item(
            'bowl', Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])), 0.8, -1.2, 1.0
        ),
        POST,
    )
    collision = detection_of(*shapes)
    rng = np.random.default_rng(7)
    axes = robot().axes_data
    verdicts = []
    for start, end in rng.uniform(axes.lower, axes.upper, (60, 2, axes.num_axes)):
        end = start + 0.4 * (end - start)  # noqa: PLW2901
        if collision.in_contact(start):
            continue
        certificate = collision.certificate(start, margin=MARGIN)
        free = certificate.line(start, end) == FREE
        # What is certified keeps RESOLUTION more than the check asks for.
        assert not free or collision.first_approach(JointPath.straight(start, end), margin=MARGIN) is None
        if not free:
            wider = collision.first_approach(JointPath.straight(start, end), margin=MARGIN + 3e-4)
            assert wider is not None
        verdicts.append(free)
    assert 0.2 < np.mean(verdicts) < 0.98


def test_settings_choose_the_planner():
    planning = PathPlanning(robot())
    settings = MotionSettings(avoid=True, avoid_budget=0.5)
    assert isinstance(planning.generator(JOINT, settings), CollisionFreeJoint)
    assert isinstance(planning.generator(JOINT_TO_POSE, settings), CollisionFreeJoint)
    assert not isinstance(planning.generator(LINE, settings), CollisionFreeJoint)
    by_name = replace(settings, avoid=False, joint_planner='collision_free')
    assert isinstance(planning.generator(JOINT, by_name), CollisionFreeJoint)
    for value in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InvalidInputError, match='avoid_budget'):
            MotionSettings(avoid_budget=value)
    with pytest.raises(InvalidInputError, match='avoid'):
        MotionSettings(avoid=1)  # type: ignore[arg-type]

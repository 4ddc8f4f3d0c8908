"""PoseReference: prediction between samples, jumps, staleness."""

import numpy as np
import pytest

from robots_core.blocks.following.pose_reference import PoseReference, moved
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose

TWIST = np.array([0.1, -0.2, 0.3, 0.5, 0.0, -0.4])
START = Pose.from_angles([1.0, 0.5, 0.8], [0.3, 0.2, -0.1])


def test_constant_motion_is_continued_from_two_samples() -> None:
    reference = PoseReference(timeout=0.2)
    reference.put(START, 1.0)
    reference.put(moved(START, TWIST, 0.1), 1.1)
    pose, twist = reference.at(1.15, 1.11)
    np.testing.assert_allclose(twist, TWIST, atol=1e-12)
    assert max(pose.distance_to(moved(START, TWIST, 0.15))) < 1e-7  # the angle of two matrices


def test_a_late_sample_stops_the_prediction() -> None:
    reference = PoseReference(timeout=0.5)
    reference.put(START, 1.0)
    reference.put(moved(START, TWIST, 0.1), 1.1)
    pose, twist = reference.at(1.4, 1.4)
    assert not twist.any()
    assert max(pose.distance_to(moved(START, TWIST, 0.25))) < 1e-7


def test_a_jump_is_no_motion() -> None:
    reference = PoseReference(timeout=0.2)
    reference.put(START, 1.0)
    there = Pose(START.r + 0.5, START.T)
    reference.put(there, 1.01)
    pose, twist = reference.at(1.02, 1.01)
    assert not twist.any()
    np.testing.assert_array_equal(pose.r, there.r)


def test_a_given_twist_replaces_the_difference() -> None:
    reference = PoseReference(timeout=0.2)
    reference.put(START, 1.0)
    reference.put_twist(TWIST, 1.0)
    pose, twist = reference.at(1.1, 1.0)
    np.testing.assert_array_equal(twist, TWIST)
    assert max(pose.distance_to(moved(START, TWIST, 0.1))) < 1e-7


def test_reports_when_it_is_stale() -> None:
    reference = PoseReference(timeout=0.2)
    assert not reference.fresh_pose(0.0)
    reference.put(START, 1.0)
    assert reference.fresh_pose(1.2)
    assert not reference.fresh_pose(1.21)
    assert not reference.fresh_twist(1.0)


def test_bad_input_is_refused() -> None:
    with pytest.raises(InvalidInputError, match='timeout'):
        PoseReference(timeout=0.0)
    with pytest.raises(InvalidInputError, match='twist'):
        PoseReference(timeout=0.1).put_twist([np.nan] * 6, 0.0)

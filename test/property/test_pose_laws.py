"""Poses form a group; angles, quaternions and rotation vectors are coordinates of it."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robots_core import Pose
from robots_core.orientation import (
    ORIENTATION_CONVENTIONS,
    angles_from_orientation,
    orientation_from_angles,
    rotation_from_vector,
    rotation_vector,
)

# Rotations are exact to a few 1e-16, positions of up to 10 m to a few 1e-15.
EXACT = 1e-12
# The sine and cosine near gimbal lock or a half turn lose half of the digits.
HALF_THE_DIGITS = 1e-7

vectors = arrays(np.float64, 3, elements=st.floats(-10.0, 10.0))
angles = arrays(np.float64, 3, elements=st.floats(-np.pi, np.pi))
small_angles = arrays(np.float64, 3, elements=st.floats(-1e-9, 1e-9))
conventions = st.sampled_from(sorted(ORIENTATION_CONVENTIONS))
poses = st.builds(Pose.from_angles, vectors, angles | small_angles, conventions)


def assert_same(first: Pose, second: Pose) -> None:
    np.testing.assert_allclose(first.r, second.r, atol=10.0 * EXACT)
    np.testing.assert_allclose(first.T, second.T, atol=EXACT)


@given(poses, poses, poses)
def test_chaining_is_associative(a: Pose, b: Pose, c: Pose):
    assert_same((a @ b) @ c, a @ (b @ c))


@given(poses)
def test_identity_changes_nothing(pose: Pose):
    assert_same(pose @ Pose.identity(), pose)
    assert_same(Pose.identity() @ pose, pose)


@given(poses)
def test_inverse_leads_back(pose: Pose):
    assert_same(pose @ pose.inverse(), Pose.identity())
    assert_same(pose.inverse() @ pose, Pose.identity())
    assert_same(pose.inverse().inverse(), pose)


@given(poses, vectors)
def test_chaining_maps_points(pose: Pose, point: np.ndarray):
    moved = pose @ Pose(point, np.eye(3))
    np.testing.assert_allclose(moved.r, pose.r + pose.T @ point, atol=10.0 * EXACT)


@given(angles | small_angles, conventions)
def test_angles_return_to_the_same_orientation(phi: np.ndarray, convention: str):
    T = orientation_from_angles(phi, convention)
    again = orientation_from_angles(angles_from_orientation(T, convention), convention)
    np.testing.assert_allclose(again, T, atol=HALF_THE_DIGITS)


@given(poses)
def test_quaternion_returns_to_the_same_pose(pose: Pose):
    quaternion = pose.quaternion()
    assert quaternion[3] >= 0.0
    np.testing.assert_allclose(np.linalg.norm(quaternion), 1.0, atol=EXACT)
    assert_same(Pose.from_quaternion(pose.r, quaternion), pose)


@given(poses)
def test_rotation_vector_returns_to_the_same_orientation(pose: Pose):
    vector = rotation_vector(pose.T)
    assert np.linalg.norm(vector) <= np.pi + EXACT
    np.testing.assert_allclose(rotation_from_vector(vector), pose.T, atol=EXACT)


@given(poses, poses)
def test_error_leads_to_the_target(start: Pose, target: Pose):
    error = start.error_to(target)
    reached = Pose(start.r + error[:3], rotation_from_vector(error[3:]) @ start.T)
    assert_same(reached, target)


@given(poses, poses)
def test_distance_is_symmetric_and_zero_to_itself(a: Pose, b: Pose):
    np.testing.assert_allclose(a.distance_to(b), b.distance_to(a), atol=HALF_THE_DIGITS)
    np.testing.assert_allclose(a.distance_to(a), 0.0, atol=HALF_THE_DIGITS)


@given(poses, poses, poses)
def test_distance_does_not_depend_on_the_reference(a: Pose, b: Pose, reference: Pose):
    moved = (reference @ a).distance_to(reference @ b)
    np.testing.assert_allclose(moved, a.distance_to(b), atol=HALF_THE_DIGITS)

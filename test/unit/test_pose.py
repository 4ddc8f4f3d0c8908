"""Pose: examples, and what is refused. Its laws are in test/property/test_pose_laws.py."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose
from robots_core.errors import InvalidInputError

HALF_TURN = np.diag([-1.0, -1.0, 1.0])
EXACT = 1e-12  # a handful of products of numbers of size one


def _x(angle: float) -> np.ndarray:
    return np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])


def _z(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])


def test_pose_is_read_only_and_keeps_no_array_of_the_caller():
    r, T = np.zeros(3), np.eye(3)
    pose = Pose(r, T)
    r[0], T[0, 0] = 5.0, 5.0
    np.testing.assert_array_equal(pose.r, 0.0)
    np.testing.assert_array_equal(pose.T, np.eye(3))
    for array in (pose.r, pose.T):
        with pytest.raises(ValueError, match='read-only'):
            array[0] = 1.0
    with pytest.raises(AttributeError):
        pose.r = r  # type: ignore[misc]


@pytest.mark.parametrize(
    ('r', 'T', 'message'),
    [
        ([0, 0], np.eye(3), r'shape \(3,\)'),
        ([0, np.nan, 0], np.eye(3), r'r\[1\] is nan'),
        ([np.inf, 0, 0], np.eye(3), r'r\[0\] is inf'),
        (['a', 0, 0], np.eye(3), '3 numbers'),
        ([0, 0, 0], np.eye(4), r'shape \(3, 3\)'),
        ([0, 0, 0], 1.1 * np.eye(3), 'not a rotation'),
        ([0, 0, 0], np.full((3, 3), np.nan), 'not a rotation'),
        ([0, 0, 0], np.diag([1.0, 1.0, -1.0]), 'left-handed'),
    ],
)
def test_what_is_no_pose_is_refused(r: list, T: np.ndarray, message: str):
    with pytest.raises(InvalidInputError, match=message):
        Pose(r, T)


def test_zero_quaternion_is_refused():
    with pytest.raises(InvalidInputError, match='length'):
        Pose.from_quaternion([0, 0, 0], [0, 0, 0, 0])


def test_a_quaternion_of_any_usable_length_is_meant_as_a_rotation_and_no_other():
    pose = Pose.from_quaternion([0, 0, 0], [0.0, 0.0, 1e8, 0.0])
    np.testing.assert_allclose(pose.T, Pose.from_quaternion([0, 0, 0], [0, 0, 1, 0]).T, atol=EXACT)
    with pytest.raises(InvalidInputError, match='length'):
        Pose.from_quaternion([0, 0, 0], [0.0, 0.0, 1e200, 0.0])


def test_quaternion_is_x_y_z_w_and_normalised():
    pose = Pose.from_quaternion([0, 0, 0], [0.0, 0.0, 3.0, 0.0])
    np.testing.assert_allclose(pose.T, HALF_TURN, atol=EXACT)
    np.testing.assert_allclose(pose.quaternion(), [0, 0, 1, 0], atol=EXACT)


def test_error_is_in_base_coordinates():
    start = Pose(np.array([1.0, 0.0, 0.0]), _z(np.pi / 2))
    target = Pose(np.array([1.0, 2.0, 0.0]), _x(0.1) @ _z(np.pi / 2))
    np.testing.assert_allclose(start.error_to(target), [0, 2, 0, 0.1, 0, 0], atol=EXACT)
    assert start.distance_to(target) == pytest.approx((2.0, 0.1), abs=EXACT)

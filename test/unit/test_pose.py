"""Pose: conventions by example, and what is refused. Its laws are in test/property/test_pose_laws.py."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose
from robots_core.errors import InvalidInputError
from robots_core.pose import ORIENTATION_CONVENTIONS, angles_from_orientation, orientation_from_angles

HALF_TURN = np.diag([-1.0, -1.0, 1.0])
EXACT = 1e-12  # a handful of products of numbers of size one


def _x(angle: float) -> np.ndarray:
    return np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])


def _y(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])


def _z(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])


def test_each_convention_turns_as_its_makers_say():
    a, b, c = 0.3, -0.7, 1.9
    expected = {
        'zyx': _z(a) @ _y(b) @ _x(c),
        'xyz': _x(a) @ _y(b) @ _z(c),
        'zyz': _z(a) @ _y(b) @ _z(c),
        'XYZ': _z(c) @ _y(b) @ _x(a),
    }
    assert set(expected) == set(ORIENTATION_CONVENTIONS)
    for convention, T in expected.items():
        np.testing.assert_allclose(orientation_from_angles([a, b, c], convention), T, atol=EXACT)


def test_unknown_convention_is_refused_with_the_known_ones():
    for call in (orientation_from_angles, lambda _, name: angles_from_orientation(np.eye(3), name)):
        with pytest.raises(InvalidInputError, match=r"'abc'.*zyx, xyz, zyz, XYZ"):
            call([0, 0, 0], 'abc')


@pytest.mark.parametrize('convention', ORIENTATION_CONVENTIONS)
@pytest.mark.parametrize('middle', [0.0, np.pi / 2, -np.pi / 2, np.pi])
def test_gimbal_lock_gives_angles_of_the_same_orientation(convention: str, middle: float):
    T = orientation_from_angles([0.4, middle, 0.9], convention)
    angles = angles_from_orientation(T, convention)
    # Near the lock an angle is known to the square root of the rounding only; the orientation is exact.
    np.testing.assert_allclose(orientation_from_angles(angles, convention), T, atol=1e-7)


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


def test_quaternion_is_x_y_z_w_and_normalised():
    pose = Pose.from_quaternion([0, 0, 0], [0.0, 0.0, 3.0, 0.0])
    np.testing.assert_allclose(pose.T, HALF_TURN, atol=EXACT)
    np.testing.assert_allclose(pose.quaternion(), [0, 0, 1, 0], atol=EXACT)


def test_error_is_in_base_coordinates():
    start = Pose(np.array([1.0, 0.0, 0.0]), _z(np.pi / 2))
    target = Pose(np.array([1.0, 2.0, 0.0]), _x(0.1) @ _z(np.pi / 2))
    np.testing.assert_allclose(start.error_to(target), [0, 2, 0, 0.1, 0, 0], atol=EXACT)
    assert start.distance_to(target) == pytest.approx((2.0, 0.1), abs=EXACT)

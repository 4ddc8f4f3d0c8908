"""Orientations: conventions by example, and the answers of SciPy. Laws: test/property/test_pose_laws.py."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core.errors import InvalidInputError
from robots_core.orientation import (
    ORIENTATION_CONVENTIONS,
    angles_from_orientation,
    orientation_from_angles,
    quaternion_of,
    quaternions_of,
    rotation_from_quaternion,
    rotation_from_vector,
    rotation_vector,
    rotation_vectors,
)

EXACT = 1e-12  # a handful of products of numbers of size one
SCIPY_NAMES = {'zyx': 'ZYX', 'xyz': 'XYZ', 'zyz': 'ZYZ', 'XYZ': 'xyz'}
VECTOR = 'rotation_vector'


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
    assert {*expected, VECTOR} == set(ORIENTATION_CONVENTIONS)
    for convention, T in expected.items():
        np.testing.assert_allclose(orientation_from_angles([a, b, c], convention), T, atol=EXACT)


def test_unknown_convention_is_refused_with_the_known_ones():
    for call in (orientation_from_angles, lambda _, name: angles_from_orientation(np.eye(3), name)):
        with pytest.raises(InvalidInputError, match=r"'abc'.*zyx, xyz, zyz, XYZ and rotation_vector"):
            call([0, 0, 0], 'abc')


@pytest.mark.parametrize('convention', SCIPY_NAMES)
@pytest.mark.parametrize('middle', [0.0, np.pi / 2, -np.pi / 2, np.pi])
def test_gimbal_lock_gives_angles_of_the_same_orientation(convention: str, middle: float):
    T = orientation_from_angles([0.4, middle, 0.9], convention)
    angles = angles_from_orientation(T, convention)
    if abs(np.sin(middle) if convention == 'zyz' else np.cos(middle)) < EXACT:
        assert angles[2] == pytest.approx(0.0, abs=EXACT)
    # Near the lock an angle is known to the square root of the rounding only; the orientation is exact.
    np.testing.assert_allclose(orientation_from_angles(angles, convention), T, atol=1e-7)


@pytest.mark.parametrize('convention', SCIPY_NAMES)
def test_angles_are_those_of_scipy(convention: str):
    for phi in np.random.default_rng(3).uniform(-np.pi, np.pi, (200, 3)):
        reference = Rotation.from_euler(SCIPY_NAMES[convention], phi)
        T = orientation_from_angles(phi, convention)
        np.testing.assert_allclose(T, reference.as_matrix(), atol=EXACT)
        expected = reference.as_euler(SCIPY_NAMES[convention])
        # Angles near gimbal lock are known less well: by the inverse of the distance, 1e-3 here.
        turn = np.exp(1j * (angles_from_orientation(T, convention) - expected))
        np.testing.assert_allclose(turn, 1.0, atol=1e-9)


def test_rotation_vectors_are_a_convention():
    vector = np.array([0.3, -0.7, 1.9])
    T = orientation_from_angles(vector, VECTOR)
    np.testing.assert_allclose(T, Rotation.from_rotvec(vector).as_matrix(), atol=EXACT)
    np.testing.assert_allclose(angles_from_orientation(T, VECTOR), vector, atol=EXACT)


@pytest.mark.parametrize('angle', [0.0, 1e-15, 1e-9, 1e-4, 1.0, 3.0, np.pi - 1e-9])
def test_vectors_and_quaternions_are_those_of_scipy(angle: float):
    for axis in np.random.default_rng(4).normal(size=(50, 3)):
        vector = angle * axis / np.linalg.norm(axis)
        reference = Rotation.from_rotvec(vector)
        T = reference.as_matrix()
        np.testing.assert_allclose(rotation_from_vector(vector), T, atol=EXACT)
        np.testing.assert_allclose(rotation_vector(T), vector, atol=EXACT)
        np.testing.assert_allclose(quaternion_of(T), reference.as_quat(canonical=True), atol=EXACT)
        np.testing.assert_allclose(rotation_from_quaternion(reference.as_quat()), T, atol=EXACT)


def test_many_at_once_are_the_same_as_one_by_one():
    rotations = Rotation.random(500, rng=5)
    half_turns = Rotation.from_rotvec(np.pi * np.eye(3))
    T = Rotation.concatenate([rotations, half_turns, Rotation.identity(1)]).as_matrix()
    np.testing.assert_allclose(quaternions_of(T), [quaternion_of(one) for one in T], atol=EXACT)
    np.testing.assert_allclose(rotation_vectors(T), [rotation_vector(one) for one in T], atol=EXACT)


@pytest.mark.parametrize('convert', [quaternion_of, rotation_vector])
def test_converting_for_hours_takes_no_memory(convert: Callable[[np.ndarray], np.ndarray]):
    T = rotation_from_vector(np.array([0.1, 0.2, 0.3]))

    def grown_by(count: int) -> int:
        before = private_memory()
        for _ in range(count):
            convert(T)
        return private_memory() - before

    grown_by(1000)
    assert grown_by(20_000) < 200  # kB: 10 bytes for each; an object left behind has more


def private_memory() -> int:
    """Memory that this process shares with no file, kB."""
    return int(Path('/proc/self/status').read_text().partition('RssAnon:')[2].split()[0])

"""Payload: bodies that become one, and bodies that cannot be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_core import Pose
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_from_vector

numbers = st.floats(-2.0, 2.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


@st.composite
def payloads(draw: st.DrawFn) -> Payload:
    """A body of four point masses: every tensor of those is one of a body."""
    masses = np.array([draw(st.floats(0.1, 5.0)) for _ in range(4)])
    points = np.array([draw(vectors) for _ in range(4)])
    return of_points(masses, points)


def of_points(masses: np.ndarray, points: np.ndarray) -> Payload:
    center = masses @ points / masses.sum()
    arms = points - center
    tensor = sum(m * (d @ d * np.eye(3) - np.outer(d, d)) for m, d in zip(masses, arms, strict=True))
    return Payload(float(masses.sum()), center, np.asarray(tensor))


def same(first: Payload, second: Payload) -> None:
    assert first.mass == pytest.approx(second.mass)
    np.testing.assert_allclose(first.center, second.center, atol=1e-12)
    np.testing.assert_allclose(first.inertia, second.inertia, atol=1e-10)  # some 100 kg m^2, to 1e-15


@given(payloads(), payloads(), payloads())
def test_sums_need_no_order(a: Payload, b: Payload, c: Payload):
    same(a + b, b + a)
    same((a + b) + c, a + (b + c))
    same(a + Payload(0.0), a)


@given(st.lists(st.tuples(st.floats(0.1, 5.0), vectors), min_size=2, max_size=6))
def test_a_body_is_the_sum_of_its_points(parts: list[tuple[float, np.ndarray]]):
    total = Payload(0.0)
    for mass, point in parts:
        total = total + Payload(mass, point)
    same(total, of_points(np.array([m for m, _ in parts]), np.array([p for _, p in parts])))


@given(payloads(), payloads(), vectors, vectors)
def test_a_sum_looks_the_same_from_everywhere(a: Payload, b: Payload, r: np.ndarray, turn: np.ndarray):
    pose = Pose(r, rotation_from_vector(turn))
    same((a + b).seen_from(pose), a.seen_from(pose) + b.seen_from(pose))
    same(a.seen_from(pose).seen_from(pose.inverse()), a)


def test_what_no_body_has_is_refused():
    with pytest.raises(InvalidInputError, match=r'mass = -1\.0 kg'):
        Payload(-1.0)
    with pytest.raises(InvalidInputError, match='mass'):
        Payload(np.nan)
    with pytest.raises(InvalidInputError, match='center'):
        Payload(1.0, np.zeros(2))
    with pytest.raises(InvalidInputError, match='symmetric'):
        Payload(1.0, np.zeros(3), np.array([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(InvalidInputError, match='not negative'):
        Payload(1.0, np.zeros(3), np.diag([-1.0, 1.0, 1.0]))
    with pytest.raises(InvalidInputError, match='largest is at most the sum'):
        Payload(1.0, np.zeros(3), np.diag([1.0, 1.0, 2.5]))

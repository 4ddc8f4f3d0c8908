from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_controller.report.motion_figures import deciding_limit
from robots_controller.report.path_accuracy import distance_to_path

TURN = np.linspace(0.0, 1.5 * np.pi, 2001)
ARC = np.stack([np.cos(TURN), np.sin(TURN), 0.0 * TURN], axis=1)


@given(st.floats(0.0, 1.5 * np.pi), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
@settings(max_examples=60)
def test_distance_to_an_arc_is_that_of_geometry(angle: float, out: float, up: float):
    point = np.array([[(1.0 + out) * np.cos(angle), (1.0 + out) * np.sin(angle), up]])
    # A chord of the arc is radius * step^2 / 8 away from it.
    chord = (TURN[1] - TURN[0]) ** 2 / 8.0
    assert distance_to_path(point, ARC)[0] == pytest.approx(np.hypot(out, up), abs=2.0 * chord)


def test_points_of_a_path_are_on_it():
    assert distance_to_path(ARC, ARC).max() == 0.0


def test_a_path_of_one_point_is_that_point():
    assert distance_to_path(np.array([[3.0, 4.0, 0.0]]), np.zeros((1, 3)))[0] == 5.0


def test_beyond_its_end_a_path_is_as_far_as_its_end():
    path = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert distance_to_path(np.array([[4.0, 4.0, 0.0]]), path)[0] == pytest.approx(5.0)


@given(st.integers(0, 2**32 - 1), st.integers(2, 60), st.floats(0.0, 0.5))
@settings(max_examples=60)
def test_no_part_of_a_path_that_crosses_and_rests_is_nearer(seed: int, count: int, away: float):
    random = np.random.default_rng(seed)
    path = np.repeat(random.uniform(-1.0, 1.0, (count, 3)), random.integers(1, 4, count), axis=0)
    points = path[random.integers(0, len(path), 20)] + away * random.uniform(-1.0, 1.0, (20, 3))
    every = np.min([distance_to_path(points, path[k : k + 2]) for k in range(len(path) - 1)], axis=0)
    assert distance_to_path(points, path) == pytest.approx(every, abs=1e-12)


def _uses(**peaks: list[float]) -> dict[str, np.ndarray]:
    return {
        name: np.array(peaks.get(name, [0.1] * 10))[:, None]
        for name in ('velocity', 'acceleration', 'torque')
    }


TIME = np.arange(10.0)
BOTH = [1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0]


def test_of_two_reached_limits_the_one_held_longer_decides():
    use = _uses(acceleration=BOTH, velocity=[0.1, 0.9, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.1])
    found = deciding_limit(TIME, use, ('A1',), np.zeros(10), cartesian=False)
    assert (found.quantity, found.joint, found.share) == ('velocity', 'A1', 0.6)


def test_where_nothing_is_reached_the_highest_use_decides():
    found = deciding_limit(TIME, _uses(torque=[0.3, *[0.2] * 9]), ('A1',), np.zeros(10), cartesian=False)
    assert (found.quantity, found.use) == ('torque', 0.3)


def test_the_tool_decides_only_where_it_follows_a_path():
    speed = np.array([0.0, 0.2, *[0.25] * 6, 0.2, 0.0])
    assert deciding_limit(TIME, _uses(), ('A1',), speed, cartesian=True).describe() == 'tool speed 0.25 m/s'
    assert deciding_limit(TIME, _uses(), ('A1',), speed, cartesian=False).joint == 'A1'

"""Blending: corners stay in their zones, two derivatives are continuous, the rest is untouched."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import Pose, load_robot_model
from robots_core.errors import InvalidInputError
from robots_core.validation import Array
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths.blending import blend, joint_distance
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.joint_path import JointPath


def straight(start: Array, end: Array) -> JointPath:
    delta = end - start
    return JointPath(
        np.array([0.0, 1.0]), np.array([start, end]), np.array([delta, delta]), np.zeros((2, len(start)))
    )


def check_smooth(path: JointPath) -> None:
    """Both derivatives are those of the positions, and continuous."""
    s = np.linspace(0.0, 1.0, 4001)
    q, q_s, q_ss = path.evaluate(s)
    scale = np.abs(q_ss).max()
    # Trapezoids of the derivatives give back what they derive, to the step squared.
    for value, slope in ((q, q_s), (q_s, q_ss)):
        change = np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(s)[:, None], axis=0)
        np.testing.assert_allclose(value[1:] - value[0], change, atol=1e-4 * (1.0 + scale))


@settings(max_examples=60)  # a thousand evaluations each
@given(
    corners=st.lists(
        st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3), min_size=3, max_size=5, unique_by=tuple
    ),
    zone=st.floats(1e-3, 1.0),
)
def test_joint_lines_are_blended_within_zones_and_untouched_outside(
    corners: list[list[float]], zone: float
) -> None:
    points = np.array(corners)
    if np.abs(np.diff(points, axis=0)).max(axis=1).min() < 0.01:
        return
    path, _ = blend(
        [straight(a, b) for a, b in pairwise(points)], [(zone, joint_distance)] * (len(points) - 2)
    )
    np.testing.assert_array_equal(path.q[0], points[0])
    np.testing.assert_allclose(path.q[-1], points[-1], atol=1e-12)
    check_smooth(path)
    q = path.evaluate(np.linspace(0.0, 1.0, 1001))[0]
    outside = np.min([joint_distance(q, corner) for corner in points[1:-1]], axis=0) > zone * (1.0 + 1e-6)
    # Outside all zones it is on one of the lines.
    away = []
    for a, b in pairwise(points):
        part = np.clip((q - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        away.append(np.abs(a + np.outer(part, b - a) - q).max(axis=1))
    assert (np.min(away, axis=0)[outside] < 1e-9).all()


def test_tool_lines_are_blended_within_metres() -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    kinematics = PathInverseKinematics(robot)
    q = robot.home + np.array([0.1, 0.1, -0.1, 0.2, 0.6, 0.1])
    start = kinematics.pose(q)
    middle = Pose(start.r + np.array([0.1, 0.2, 0.0]), start.T)
    end = Pose(middle.r + np.array([0.1, -0.1, 0.2]), start.T)
    first = kinematics.follow(CartesianLine(start, middle), q)
    second = kinematics.follow(CartesianLine(middle, end), first.q[-1])

    def distance(q: Array, corner: Array) -> Array:
        return np.linalg.norm(robot.tool_poses(q)[0] - kinematics.pose(corner).r, axis=1)

    path, _ = blend([first, second], [(0.03, distance)])
    check_smooth(path)
    rounded = 0
    for sample in path.evaluate(np.linspace(0.0, 1.0, 501))[0]:
        r = kinematics.pose(sample).r
        away = []
        for a, b in ((start.r, middle.r), (middle.r, end.r)):
            part = np.clip((r - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
            away.append(float(np.linalg.norm(a + part * (b - a) - r)))
        if min(away) > 1e-5:
            rounded += 1
            assert np.linalg.norm(r - middle.r) <= 0.03
    assert rounded > 10


def test_bad_input_is_refused() -> None:
    a, b, c = np.zeros(2), np.ones(2), np.array([1.0, 2.0])
    first = straight(a, b)
    with pytest.raises(InvalidInputError, match='path 1 begins 1 rad from where path 0 ends'):
        blend([first, straight(c, a)], [(0.1, joint_distance)])
    alone, _ = blend([first], [])
    np.testing.assert_allclose(alone.evaluate(np.array([0.3]))[0], [[0.3, 0.3]], atol=1e-15)

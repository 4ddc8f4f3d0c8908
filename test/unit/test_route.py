"""Routes: parts of a path that were followed on their own, made one."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from robots_core import BaseRobotModel, load_robot_model
from robots_core.pose import Pose
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.path_kinematics.route import RoutePiece, joined
from robots_planning.paths.cartesian_line import CartesianLine

START = np.radians([10.0, -80.0, 100.0, -100.0, -80.0, 20.0])
BREAKS = [0.0, 0.3, 0.3 + 1e-7, 1.0]


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('ur5e')


@pytest.fixture(scope='module')
def line(robot: BaseRobotModel) -> CartesianLine:
    start = Pose(*robot.direct_kinematics(START))
    return CartesianLine(start, Pose(start.r + np.array([0.05, 0.2, 0.1]), start.T))


def parts_of(robot: BaseRobotModel, line: CartesianLine) -> list[RoutePiece]:
    """The line in three parts, the middle one very short and the first two followed backwards."""
    kinematics = PathInverseKinematics(robot)
    whole = kinematics.follow(line, START)
    parts = []
    for begin, end in pairwise(BREAKS):
        first, last = (end, begin) if end < 0.5 else (begin, end)
        followed, _ = kinematics.follow_far(line.part(first, last), whole.evaluate([first])[0][0])
        assert followed is not None
        part = replace(followed, begin=first, end=last)
        parts.append(part if first < last else part.backwards())
    return parts


def test_parts_are_the_whole(robot: BaseRobotModel, line: CartesianLine) -> None:
    whole = PathInverseKinematics(robot).follow(line, START)
    piece = joined(parts_of(robot, line))
    assert (piece.begin, piece.end) == (0.0, 1.0)
    s = np.linspace(0.0, 1.0, 301)
    # The tool is followed to 2e-7 m, the axes therefore to some 1e-6 rad.
    for found, expected in zip(piece.joints.evaluate(s)[:2], whole.evaluate(s)[:2], strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-5)


def test_ends_are_exact(robot: BaseRobotModel, line: CartesianLine) -> None:
    parts = parts_of(robot, line)
    joints = joined(parts).joints
    np.testing.assert_array_equal(joints.q[0], parts[0].joints.q[0])
    np.testing.assert_array_equal(joints.q[-1], parts[-1].joints.q[-1])
    assert (np.diff(joints.s) > 0.0).all()


def test_backwards_is_the_way_back(robot: BaseRobotModel, line: CartesianLine) -> None:
    part = parts_of(robot, line)[2]
    there, back = joined([part]), joined([part.backwards()])
    assert (back.begin, back.end) == (part.end, part.begin)
    s = np.linspace(0.0, 1.0, 101)
    for order, sign in enumerate((1.0, -1.0, 1.0)):
        found, expected = back.joints.evaluate(s)[order], there.joints.evaluate(1.0 - s)[order]
        # Rounding of 1 - s, divided by the short steps of the path to that power.
        np.testing.assert_allclose(found, sign * expected, atol=1e-9)


def test_a_whole_turn_is_everywhere(robot: BaseRobotModel, line: CartesianLine) -> None:
    piece = joined(parts_of(robot, line))
    turn = 2.0 * np.pi * np.array([0.0, 0.0, 0.0, 1.0, 0.0, -1.0])
    s = np.linspace(0.0, 1.0, 51)
    before, after = piece.joints.evaluate(s), piece.turned(turn).joints.evaluate(s)
    np.testing.assert_allclose(after[0] - before[0], np.tile(turn, (51, 1)), atol=1e-12)
    np.testing.assert_allclose(after[1], before[1], atol=1e-9)

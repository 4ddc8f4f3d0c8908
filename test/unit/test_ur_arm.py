"""ur_arm: which arms it takes, and what it says of the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.robot_model.analytic.arm_record import ur_arm
from robots_core.robot_model.analytic.axis_lines import AxisLines

X, Y, Z = np.eye(3)

# The published lengths of the UR5e, arm along -x.
UR5E = AxisLines(
    'ur5e',
    directions=np.array([Z, -Y, -Y, -Y, -Z, -Y]),
    points=np.array(
        [
            [0.0, 0.0, 0.1625],
            [0.0, 0.0, 0.1625],
            [-0.425, 0.0, 0.1625],
            [-0.8172, -0.1333, 0.1625],
            [-0.8172, -0.1333, 0.0628],
            [-0.8172, -0.2329, 0.0628],
        ]
    ),
    r=np.array([-0.8172, -0.2329, 0.0628]),
    T=np.array([X, -Z, Y]).T,
)


def changed(index: int, direction: np.ndarray | None = None, shift: np.ndarray | None = None) -> AxisLines:
    directions, points = UR5E.directions.copy(), UR5E.points.copy()
    if direction is not None:
        directions[index - 1] = direction / np.linalg.norm(direction)
    if shift is not None:
        points[index - 1] += shift
    return replace(UR5E, directions=directions, points=points)


def test_published_lengths_come_back():
    record, deviation = ur_arm(UR5E)
    arm = record[0]
    assert deviation < 1e-15
    assert arm['upper_arm'] == pytest.approx(0.425, abs=1e-12)
    assert arm['forearm'] == pytest.approx(0.3922, abs=1e-12)
    assert np.linalg.norm(arm['hand']) == pytest.approx(0.0997, abs=1e-12)
    assert arm['offset'] == pytest.approx(0.1333, abs=1e-12)
    assert np.linalg.norm(arm['wrist_point']) == pytest.approx(0.0996, abs=1e-12)


def test_signs_of_the_parallel_axes_are_free():
    record, _ = ur_arm(changed(3, direction=Y))
    assert (record[0]['sign_3'], record[0]['sign_4']) == (-1.0, 1.0)


@pytest.mark.parametrize(
    ('lines', 'words'),
    [
        (changed(4, direction=Z), 'axes 2, 3 and 4 are not parallel'),
        (changed(6, shift=0.01 * X), 'axes 5 and 6 do not meet in one point'),
        (changed(1, direction=Y), 'axes 1 and 2 are parallel'),
        (changed(4, shift=np.array([0.3922, 0.0, 0.0])), 'axes 3 and 4 are the same line'),
    ],
)
def test_other_arms_are_refused_by_reason(lines: AxisLines, words: str):
    with pytest.raises(NoAnalyticInverseKinematicsError, match=words):
        ur_arm(lines)

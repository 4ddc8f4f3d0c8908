"""spherical_wrist: which arms it takes, and what it says of the others."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from robots_core import UrdfRobotModel, load_robot_model
from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.robot_model.analytic.arm_record import spherical_wrist
from robots_core.robot_model.analytic.axis_lines import STRUCTURE_TOLERANCE, AxisLines

X, Y, Z = np.eye(3)

# An arm lying along x, with the published lengths of the KUKA KR 210 R2700-2.
KUKA = AxisLines(
    'kuka',
    directions=np.array([-Z, Y, Y, -X, Y, -X]),
    points=np.array(
        [
            [0.0, 0.0, 0.0],
            [0.33, 0.0, 0.645],
            [1.48, 0.0, 0.645],
            [1.48, 0.0, 0.76],
            [2.70, 0.0, 0.76],
            [2.70, 0.0, 0.76],
        ]
    ),
    r=np.array([2.915, 0.0, 0.76]),
    T=np.array([Z, Y, -X]).T,
)


def changed(index: int, direction: np.ndarray | None = None, shift: np.ndarray | None = None) -> AxisLines:
    directions, points = KUKA.directions.copy(), KUKA.points.copy()
    if direction is not None:
        directions[index - 1] = direction / np.linalg.norm(direction)
    if shift is not None:
        points[index - 1] += shift
    return replace(KUKA, directions=directions, points=points)


def test_published_lengths_come_back():
    record, deviation = spherical_wrist(KUKA)
    arm = record[0]
    assert deviation < 1e-15
    assert arm['upper_arm'] == pytest.approx(1.15, abs=1e-12)
    assert arm['forearm'] == pytest.approx(np.hypot(1.22, 0.115), abs=1e-12)
    assert np.linalg.norm(arm['shoulder']) == pytest.approx(np.hypot(0.33, 0.645), abs=1e-12)
    assert np.linalg.norm(arm['wrist_point']) == pytest.approx(0.215, abs=1e-12)


def test_any_point_of_an_axis_will_do():
    for index in range(1, 7):
        moved, _ = spherical_wrist(changed(index, shift=0.7 * KUKA.directions[index - 1]))
        assert moved[0]['forearm'] == pytest.approx(np.hypot(1.22, 0.115), abs=1e-12)


def test_what_printed_angles_leave_is_taken_and_reported():
    _, deviation = spherical_wrist(changed(6, shift=4e-6 * Y))
    assert 1e-6 < deviation < STRUCTURE_TOLERANCE


@pytest.mark.parametrize(
    ('lines', 'words'),
    [
        (changed(6, shift=0.01 * Y), 'axes 4, 5 and 6 do not meet in one point'),
        (changed(3, direction=Z), 'axes 2 and 3 are not parallel'),
        (changed(1, direction=Y), 'axes 1 and 2 are parallel'),
        (changed(5, direction=X), 'axes 4 and 5 are parallel'),
        (changed(6, direction=Y), 'axes 5 and 6 are parallel'),
        (changed(3, shift=np.array([1.22, 0.0, 0.115])), 'the wrist centre lies on axis 3'),
        (changed(3, shift=np.array([-1.15, 0.0, 0.0])), 'axes 2 and 3 are the same line'),
    ],
)
def test_other_arms_are_refused_by_reason(lines: AxisLines, words: str):
    with pytest.raises(NoAnalyticInverseKinematicsError, match=words) as caught:
        spherical_wrist(lines)
    assert "'kuka'" in str(caught.value)


@pytest.mark.parametrize(
    ('robot', 'words'),
    [('kuka_lbr_iiwa14', 'it has 7 axes'), ('kinova_j2n6s300', 'axes 4, 5 and 6 do not meet in one point')],
)
def test_real_robots_without_closed_form_say_why(robot: str, words: str):
    model = load_robot_model(robot)
    with pytest.raises(NoAnalyticInverseKinematicsError, match=words):
        model.inverse_kinematics_analytic(*model.direct_kinematics(model.home))


def test_an_axis_that_slides_is_named(tmp_path: Path):
    text = load_robot_model('kuka_kr210_r2700').description
    (tmp_path / 'arm.urdf').write_text(
        text.replace('name="A3" type="revolute"', 'name="A3" type="prismatic"')
    )
    model = UrdfRobotModel(tmp_path / 'arm.urdf')
    with pytest.raises(NoAnalyticInverseKinematicsError, match=re.escape('axis 3 (A3) slides')):
        model.inverse_kinematics_analytic(*model.direct_kinematics(model.home))

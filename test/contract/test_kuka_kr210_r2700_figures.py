"""The KUKA's figures against its published ones.

Source: github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0),
kuka_quantec_support/urdf/kr210_r2700_2_macro.xacro and config/kr210_r2700_2_joint_limits.yaml.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest

from robots_core import load_robot_model
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel

# The axes' directions and a point on each, in the base frame with all joints at zero.
AXES_AT_ZERO = (
    ((0.0, 0.0, -1.0), (0.0, 0.0, 0.0)),
    ((0.0, 1.0, 0.0), (0.33, 0.0, 0.645)),
    ((0.0, 1.0, 0.0), (1.48, 0.0, 0.645)),
    ((-1.0, 0.0, 0.0), (1.48, 0.0, 0.76)),
    ((0.0, 1.0, 0.0), (2.7, 0.0, 0.76)),
    ((-1.0, 0.0, 0.0), (2.7, 0.0, 0.76)),
)
LIMITS = {  # lower and upper rad, velocity rad/s, acceleration rad/s^2, effort N m
    'A1': (-3.2288591161895095, 3.2288591161895095, 2.0384, 1.98271, 7290.0),
    'A2': (-2.443460952792061, -0.08726646259971647, 1.9451, 1.26288, 8910.0),
    'A3': (-2.0943951023931953, 2.9321531433504737, 1.9547687622336491, 2.56508, 6988.84717),
    'A4': (-6.1086523819801535, 6.1086523819801535, 3.12413936106985, 7.03857, 2274.29199),
    'A5': (-2.181661564992912, 2.181661564992912, 3.001966313430247, 1.76397, 1398.30298),
    'A6': (-6.1086523819801535, 6.1086523819801535, 3.839724354387525, 1.87268, 781.554626),
}
MASSES = (225.96, 363.07, 232.06, 190.33, 42.411794929, 16.991732133, 6.6)  # kg, base first
# The description prints right angles as 1.57079632679, 5e-12 rad too small: four of them over 3 m.
EXACT = 1e-10


@pytest.fixture(scope='module')
def kuka() -> UrdfRobotModel:
    robot = load_robot_model('kuka_kr210_r2700')
    assert isinstance(robot, UrdfRobotModel)
    return robot


@pytest.mark.parametrize('index', range(6))
def test_axis_lies_where_published(kuka: UrdfRobotModel, index: int):
    direction, point = np.array(AXES_AT_ZERO[index])
    r, T = kuka.kinematic_model.frame_axes(np.zeros(6))
    np.testing.assert_allclose(T[index][:, 2], direction, atol=EXACT)
    np.testing.assert_allclose(np.cross(r[index] - point, direction), 0.0, atol=EXACT)
    # Its column of the Jacobian turns tool0 about that line, in the positive sense of its direction.
    tool0, _ = kuka.direct_kinematics(np.zeros(6))
    column = kuka.jacobian(np.zeros(6))[:, index]
    np.testing.assert_allclose(column, [*np.cross(direction, tool0 - point), *direction], atol=EXACT)


def test_flange_at_zero_looks_forward(kuka: UrdfRobotModel):
    r, T = kuka.direct_kinematics(np.zeros(6))
    np.testing.assert_allclose(r, [2.915, 0.0, 0.76], atol=EXACT)
    np.testing.assert_allclose(T[:, 2], [1.0, 0.0, 0.0], atol=EXACT)
    np.testing.assert_allclose(T[:, 0], [0.0, 0.0, -1.0], atol=EXACT)


def test_limits_are_the_published_ones(kuka: UrdfRobotModel):
    axes = kuka.axes_data
    assert axes.names == tuple(LIMITS)
    for index, figures in enumerate(LIMITS.values()):
        mine = (axes.lower, axes.upper, axes.velocity, axes.acceleration, axes.effort)
        assert tuple(values[index] for values in mine) == figures


def test_masses_are_the_published_ones(kuka: UrdfRobotModel):
    np.testing.assert_allclose(kuka.rigid_dynamics_model.masses, MASSES, rtol=1e-12)


def _closed_form(kuka: UrdfRobotModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position of tool0 and direction of its z axis with A4 = 0, from the structural data alone.

    The arm then moves in one plane; angles count downwards from the horizontal.
    """
    data = kuka.structural_data
    a, b, c = q[1], q[1] + q[2], q[1] + q[2] + q[4]
    x = data.axis_1_to_axis_2 + data.upper_arm * cos(a)
    z = data.axis_2_height - data.upper_arm * sin(a)
    x += data.forearm * cos(b) + data.elbow_offset * sin(b) + data.flange * cos(c)
    z += -data.forearm * sin(b) + data.elbow_offset * cos(b) - data.flange * sin(c)
    plane = np.array([cos(-q[0]), sin(-q[0]), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    return x * plane + z * up, cos(c) * plane - sin(c) * up


@pytest.mark.parametrize(
    'q',
    [
        (0.0, -1.5, 1.5, 0.0, 0.0, 0.0),
        (0.7, -0.4, 0.9, 0.0, 0.3, 0.0),
        (-2.1, -2.0, 2.5, 0.0, -1.1, 1.0),
        (3.0, -0.1, -2.0, 0.0, 2.1, -3.0),
    ],
)
def test_pose_is_that_of_the_plane_arm(kuka: UrdfRobotModel, q: tuple[float, ...]):
    r, T = kuka.direct_kinematics(np.array(q))
    expected_r, expected_z = _closed_form(kuka, np.array(q))
    np.testing.assert_allclose(r, expected_r, atol=EXACT)
    np.testing.assert_allclose(T[:, 2], expected_z, atol=EXACT)


def test_reach_is_the_published_one(kuka: UrdfRobotModel):
    """Farthest wrist centre from axis 1: A2 and A3 as straight as the limits allow."""
    data, axes = kuka.structural_data, kuka.axes_data
    a2, a3 = np.meshgrid(
        np.linspace(axes.lower[1], axes.upper[1], 1001), np.linspace(axes.lower[2], axes.upper[2], 1001)
    )
    distance = (
        data.axis_1_to_axis_2
        + data.upper_arm * np.cos(a2)
        + data.forearm * np.cos(a2 + a3)
        + data.elbow_offset * np.sin(a2 + a3)
    )
    # The data sheet's figure is rounded to millimetres.
    assert distance.max() == pytest.approx(data.reach, abs=5e-4)


def test_data_sheet_facts_are_kept(kuka: UrdfRobotModel):
    data = kuka.structural_data
    assert (data.rated_payload_kg, data.payload_held_everywhere_kg) == (210.0, 177.0)
    assert data.effort_estimate == (6711.0, 14900.0, 5911.0, 967.5, 835.8, 124.7)
    assert 'kuka_robot_descriptions' in data.source

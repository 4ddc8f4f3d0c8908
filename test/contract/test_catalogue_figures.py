"""The robots of this package against their published figures.

`figures/` holds the figures once more, apart from the robots' own files. A Pinocchio model is built straight
from them, joint by joint, without any URDF; the arms' structural data are tested by closed forms.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import yaml

from robots_core import Pose, load_robot_model
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel

FOLDER = Path(__file__).parent / 'figures'
PUBLISHED = sorted(file.stem for file in FOLDER.glob('*.yaml'))
OURS = (*PUBLISHED, 'bello_bot', 'cello_bot', 'debris_arm')
# Figures are used as they are: sums of some ten products of lengths of metres.
EXACT = 1e-12
# Published right angles are printed with ten to twelve digits: up to 2e-10 rad each, over 3 m of arm.
PRINTED = 3e-9


def figures_of(name: str) -> dict[str, Any]:
    return yaml.safe_load((FOLDER / f'{name}.yaml').read_text())


def robot_of(name: str) -> UrdfRobotModel:
    robot = load_robot_model(name)
    assert isinstance(robot, UrdfRobotModel)
    return robot


@pytest.fixture(params=PUBLISHED)
def published(request: pytest.FixtureRequest) -> tuple[UrdfRobotModel, dict[str, Any]]:
    return robot_of(request.param), figures_of(request.param)


def postures(robot: UrdfRobotModel, count: int) -> np.ndarray:
    axes = robot.axes_data
    lower, upper = (
        np.where(axes.continuous, sign * np.pi, end) for sign, end in ((-1, axes.lower), (1, axes.upper))
    )
    return np.random.default_rng(11).uniform(lower, upper, (count, axes.num_axes))


def placement(xyz: list[float], rpy: list[float]) -> pin.SE3:
    return pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(xyz))


def reference_model(figures: dict[str, Any]) -> pin.Model:
    model, parent = pin.Model(), 0
    for axis, body in zip(figures['axes'], figures['bodies'], strict=True):
        joint = pin.JointModelRevoluteUnaligned(np.array(axis['axis']))
        parent = model.addJoint(parent, joint, placement(axis['xyz'], axis['rpy']), axis['name'])
        xx, xy, xz, yy, yz, zz = body['inertia']
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        model.appendBodyToJoint(
            parent, pin.Inertia(body['mass'], np.array(body['com']), inertia), pin.SE3.Identity()
        )
    flange = placement(figures['flange']['xyz'], figures['flange']['rpy'])
    model.addFrame(pin.Frame('tool0', parent, flange, pin.FrameType.OP_FRAME))
    return model


def test_pose_and_torques_are_those_of_the_figures(published: tuple[UrdfRobotModel, dict[str, Any]]):
    robot, figures = published
    model = reference_model(figures)
    data = model.createData()
    samples = postures(robot, 60)
    for q, q_dot, q_ddot in zip(
        samples, np.roll(samples, 1, axis=0), np.roll(samples, 2, axis=0), strict=True
    ):
        pin.framesForwardKinematics(model, data, q)
        tool0 = data.oMf[model.getFrameId('tool0')]
        r, T = robot.direct_kinematics(q)
        np.testing.assert_allclose(r, tool0.translation, atol=EXACT)
        np.testing.assert_allclose(T, tool0.rotation, atol=EXACT)
        expected = pin.rnea(model, data, q, q_dot, q_ddot)
        tau, _, _ = robot.rigid_dynamics(q, q_dot, q_ddot)
        np.testing.assert_allclose(tau, expected, atol=EXACT * np.abs(expected).max())


def test_limits_are_those_of_the_figures(published: tuple[UrdfRobotModel, dict[str, Any]]):
    robot, figures = published
    axes = robot.axes_data
    assert axes.names == tuple(axis['name'] for axis in figures['axes'])
    for index, axis in enumerate(figures['axes']):
        assert axes.lower[index] == axis.get('lower', -np.inf)
        assert axes.upper[index] == axis.get('upper', np.inf)
        for key in ('velocity', 'acceleration', 'jerk', 'effort', 'gear_ratio', 'rotor_inertia'):
            np.testing.assert_array_equal(
                getattr(axes, key)[index], axis[key], err_msg=f'{axis["name"]} {key}'
            )


def test_axes_lie_where_published(published: tuple[UrdfRobotModel, dict[str, Any]]):
    robot, figures = published
    zero = np.zeros(robot.num_axes)
    jacobian, (tool0, _) = robot.jacobian(zero), robot.direct_kinematics(zero)
    for index, (direction, point) in enumerate(figures.get('axes_in_base_at_zero', [])):
        expected = [*np.cross(direction, tool0 - point), *direction]
        # The figures' directions and points are rounded to twelve digits.
        np.testing.assert_allclose(jacobian[:, index], expected, atol=1e-9)


@pytest.mark.parametrize('name', OURS)
def test_effort_holds_the_robot_in_every_posture(name: str):
    robot = robot_of(name)
    zero = np.zeros(robot.num_axes)
    for q in postures(robot, 400):
        _, _, gravity = robot.rigid_dynamics(q, zero, zero)
        assert (np.abs(gravity) < robot.axes_data.effort).all()


@pytest.mark.parametrize('name', OURS)
def test_source_says_what_is_estimated_or_fictive(name: str):
    source = robot_of(name).structural_data.source
    assert 'ictive' in source or ('github.com/' in source and 'stimated' in source)


def _plane(turn: float) -> np.ndarray:
    return np.array([np.cos(turn), np.sin(turn), 0.0])


UP = np.array([0.0, 0.0, 1.0])


def _upright_arm(
    q: np.ndarray, data: Any, *, shoulder_offset: float = 0.0, elbow_offset: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Arm that stands upright at zero and leans forward, axis 4 at zero: tool position and direction."""
    a, b, c = q[1], q[1] + q[2], q[1] + q[2] + q[4]
    forward = shoulder_offset + data.upper_arm * np.sin(a) - elbow_offset * np.cos(b)
    forward += data.forearm * np.sin(b) + data.flange * np.sin(c)
    height = data.shoulder_height + data.upper_arm * np.cos(a) + elbow_offset * np.sin(b)
    height += data.forearm * np.cos(b) + data.flange * np.cos(c)
    return forward * _plane(q[0]) + height * UP, np.sin(c) * _plane(q[0]) + np.cos(c) * UP


def _staubli(robot: UrdfRobotModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data: Any = robot.structural_data
    r, z = _upright_arm(q, data, shoulder_offset=data.shoulder_offset)
    return r + data.lateral_offset * np.cross(UP, _plane(q[0])), z


def _mitsubishi(robot: UrdfRobotModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data: Any = robot.structural_data
    return _upright_arm(q, data, elbow_offset=data.elbow_offset)


def _manutec(robot: UrdfRobotModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Leans towards -y, where its shoulder stands; its elbow goes back."""
    data: Any = robot.structural_data
    turned = q - 0.5 * np.pi * np.eye(6)[0]
    return _upright_arm(turned, data, shoulder_offset=data.shoulder_offset, elbow_offset=data.elbow_offset)


def _kuka(robot: UrdfRobotModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Stretched forward at zero, axis 1 turns clockwise."""
    data = robot.structural_data
    a, b, c = q[1], q[1] + q[2], q[1] + q[2] + q[4]
    forward = data.axis_1_to_axis_2 + data.upper_arm * np.cos(a) + data.forearm * np.cos(b)
    forward += data.elbow_offset * np.sin(b) + data.flange * np.cos(c)
    height = data.axis_2_height - data.upper_arm * np.sin(a) - data.forearm * np.sin(b)
    height += data.elbow_offset * np.cos(b) - data.flange * np.sin(c)
    return forward * _plane(-q[0]) + height * UP, np.cos(c) * _plane(-q[0]) - np.sin(c) * UP


CLOSED_FORMS: dict[str, Callable[..., Any]] = {
    'kuka_kr210_r2700': _kuka,
    'kuka_kr210_r3100': _kuka,
    'kuka_kr500_r2830': _kuka,
    'staubli_tx2_90': _staubli,
    'staubli_rx160': _staubli,
    'mitsubishi_rv7frl': _mitsubishi,
    'manutec_r3': _manutec,
}


@pytest.mark.parametrize('name', CLOSED_FORMS)
def test_structural_data_are_those_of_the_plane_arm(name: str):
    robot = robot_of(name)
    for q in postures(robot, 30):
        q[3] = 0.0
        r, T = robot.direct_kinematics(q)
        expected_r, expected_z = CLOSED_FORMS[name](robot, q)
        np.testing.assert_allclose(r, expected_r, atol=PRINTED)
        np.testing.assert_allclose(T[:, 2], expected_z, atol=PRINTED)


@pytest.mark.parametrize('name', ['ur5e', 'ur10e'])
def test_structural_data_are_the_denavit_hartenberg_lengths(name: str):
    """Standard Denavit-Hartenberg: turn about z, shift d along z and a along x, tilt alpha about x."""
    robot = robot_of(name)
    data = robot.structural_data
    rows = (
        (0.0, data.d1, 0.5 * np.pi),
        (data.a2, 0.0, 0.0),
        (data.a3, 0.0, 0.0),
        (0.0, data.d4, 0.5 * np.pi),
        (0.0, data.d5, -0.5 * np.pi),
        (0.0, data.d6, 0.0),
    )
    for q in postures(robot, 30):
        pose = pin.SE3.Identity()
        for angle, (a, d, alpha) in zip(q, rows, strict=True):
            turn = pin.rpy.rpyToMatrix(0.0, 0.0, angle)
            tilt = pin.rpy.rpyToMatrix(alpha, 0.0, 0.0)
            pose = pose * pin.SE3(turn @ tilt, turn @ np.array([a, 0.0, d]))
        r, T = robot.direct_kinematics(q)
        np.testing.assert_allclose(r, pose.translation, atol=PRINTED)
        np.testing.assert_allclose(T, pose.rotation, atol=PRINTED)


UR_DESCRIPTION = {
    'ur5e': ((0.0, 0.0, 0.1625), -0.425, (-0.3922, 0.0, 0.1333), -0.0997, 0.0996),
    'ur10e': ((0.0, 0.0, 0.1807), -0.6127, (-0.57155, 0.0, 0.17415), -0.11985, 0.11655),
}
"""Universal_Robots_ROS2_Description @2221ec0, config/*/default_kinematics.yaml: shoulder, x of forearm,
wrist_1, y of wrist_2 and of wrist_3, m; their z, -2e-11 m, is left out. Joints: urdf/ur_macro.xacro."""


def placed(xyz: tuple[float, float, float], rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> pin.SE3:
    return pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(xyz))


@pytest.mark.parametrize('name', UR_DESCRIPTION)
def test_base_link_is_that_of_the_maker_s_description(name: str):
    shoulder, forearm, wrist_1, wrist_2, wrist_3 = UR_DESCRIPTION[name]
    half, here = 0.5 * np.pi, (0.0, 0.0, 0.0)
    joints = (
        placed(shoulder),
        placed(here, (1.570796327, 0.0, 0.0)),
        placed((forearm, 0.0, 0.0)),
        placed(wrist_1),
        placed((0.0, wrist_2, 0.0), (1.570796327, 0.0, 0.0)),
        placed((0.0, wrist_3, 0.0), (1.570796326589793, np.pi, np.pi)),
    )
    robot = robot_of(name)
    for q in postures(robot, 10):
        pose = placed(here, (0.0, 0.0, np.pi))  # base_link-base_link_inertia
        for origin, angle in zip(joints, q, strict=True):
            pose = pose * origin * placed(here, (0.0, 0.0, angle))
        pose = pose * placed(here, (0.0, -half, -half))  # wrist_3-flange
        pose = pose * placed(here, (half, 0.0, half))  # flange-tool0
        r, T = robot.direct_kinematics(q)
        there = robot.base_link @ Pose(pose.translation, pose.rotation)
        np.testing.assert_allclose(there.r, r, atol=PRINTED)
        np.testing.assert_allclose(there.T, T, atol=PRINTED)


def test_iiwa_shoulder_elbow_and_wrist_are_points():
    robot = robot_of('kuka_lbr_iiwa14')
    data = robot.structural_data
    r, _ = robot.kinematic_model.frame_axes(np.zeros(7))
    heights = np.cumsum([data.shoulder_height, data.upper_arm, data.forearm, data.flange])
    np.testing.assert_allclose(r[[1, 3, 5], 2], heights[:3], atol=EXACT)
    tool0, _ = robot.direct_kinematics(np.zeros(7))
    np.testing.assert_allclose(tool0, [0.0, 0.0, heights[3]], atol=EXACT)


def test_franka_at_zero_hangs_its_flange_beside_the_forearm():
    robot = robot_of('franka_fr3')
    data = robot.structural_data
    tool0, T = robot.direct_kinematics(np.zeros(7))
    top = data.shoulder_height + data.upper_arm + data.forearm
    np.testing.assert_allclose(tool0, [data.wrist_offset, 0.0, top - data.flange], atol=PRINTED)
    np.testing.assert_allclose(T[:, 2], -UP, atol=PRINTED)


def test_jaco_as_a_candle_is_as_high_as_its_table_says():
    """All joints at pi: upright, the wrist's axes 60 degrees from each other."""
    robot = robot_of('kinova_j2n6s300')
    data = robot.structural_data
    r, T = robot.kinematic_model.frame_axes(np.full(6, np.pi))
    np.testing.assert_allclose(r[1:4, 2], np.cumsum([data.d1, data.d2, data.d3]), atol=PRINTED)
    for index in (3, 4):
        cosine = abs(T[index][:, 2] @ T[index + 1][:, 2])
        np.testing.assert_allclose(cosine, np.cos(data.wrist_angle), atol=PRINTED)
    # The maker's table gives four digits.
    np.testing.assert_allclose(np.linalg.norm(r[4] - r[3]), data.d4, atol=5e-5)
    np.testing.assert_allclose(np.linalg.norm(r[5] - r[4]), data.d5, atol=5e-5)


def test_franka_rectangular_limits_are_inside_the_velocity_limits_by_position():
    robot = load_robot_model('franka_fr3', limits='rectangular')
    wide = load_robot_model('franka_fr3').axes_data
    axes, data = robot.axes_data, robot.structural_data
    assert ((axes.lower > wide.lower) & (axes.upper < wide.upper) & (axes.velocity < wide.velocity)).all()
    for q in (axes.lower, axes.upper, robot.home):
        low, high = data.velocity_limits(q)
        assert (low <= 0.0).all()
        assert (high >= 0.0).all()
    # The maker rounds the ends of the ranges to 1e-4 rad; the limits fall by up to 5 rad/s per rad there.
    assert (data.velocity_limits(axes.upper)[1] >= axes.velocity - 5e-4).all()
    assert (data.velocity_limits(axes.lower)[0] <= -axes.velocity + 5e-4).all()
    assert (data.velocity_limits(wide.upper)[1] < 0.6 * wide.velocity).all()


def test_debris_arm_can_be_weightless():
    orbit = load_robot_model('debris_arm?gravity=0,0,0')
    zero = np.zeros(3)
    np.testing.assert_array_equal(orbit.rigid_dynamics(orbit.home, zero, zero)[2], zero)


def test_cello_bot_slides_first():
    robot = robot_of('cello_bot')
    data = robot.structural_data
    assert robot.axes_data.prismatic == (True, False, False, False, False)
    assert (robot.axes_data.lower[0], robot.axes_data.upper[0]) == (0.0, data.stroke)
    tool0, _ = robot.direct_kinematics(np.array([0.3, 0.0, 0.0, 0.0, 0.0]))
    reach = data.neck_offset + data.shoulder_offset + data.upper_arm + data.forearm + data.hand
    np.testing.assert_allclose(tool0, [reach, 0.0, data.lowest_carriage + 0.3 + data.elbow_rise], atol=EXACT)

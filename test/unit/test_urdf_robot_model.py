"""UrdfRobotModel: any URDF becomes a robot."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from robots_core import UrdfRobotModel, load_robot_model
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.errors import InvalidInputError, UnknownRobotError
from robots_core.robot_model.shapes import Box, Cylinder, Mesh, Sphere

from .plane_arm import ARM, write_arm

EXACT = 1e-12  # some ten operations on numbers of size one


@pytest.fixture
def arm(tmp_path: Path) -> UrdfRobotModel:
    return UrdfRobotModel(write_arm(tmp_path))


def test_pose_is_that_of_the_plane_arm(arm: UrdfRobotModel):
    for q in np.random.default_rng(1).uniform(-4.0, 4.0, (20, 3)):
        a, b = q[0], q[0] + q[1]
        r, T = arm.direct_kinematics(q)
        along = np.array([np.cos(b), np.sin(b), 0.0])
        np.testing.assert_allclose(r, [np.cos(a), np.sin(a), 0.0] + 1.2 * along, atol=EXACT)
        np.testing.assert_allclose(T[:, 0], along, atol=EXACT)
        up = np.array([0.0, 0.0, 1.0])
        turned = np.cos(q[2]) * up - np.sin(q[2]) * np.cross(up, along)
        np.testing.assert_allclose(T[:, 2], turned, atol=EXACT)


def test_continuous_axis_turns_any_number_of_times(arm: UrdfRobotModel):
    assert arm.axes_data.continuous[2]
    q = np.array([1.0, 0.5, 0.3])
    for mine, its in zip(
        arm.direct_kinematics(q), arm.direct_kinematics(q + np.array([0.0, 0.0, 40.0 * np.pi])), strict=True
    ):
        np.testing.assert_allclose(mine, its, atol=1e-12)  # 40 pi is rounded to 1e-14
    assert (arm.axes_data.check_position([1.0, 0.0, 1e4]) == [1.0, 0.0, 1e4]).all()


def test_fixed_branches_weigh_on_the_body_that_carries_them(arm: UrdfRobotModel):
    dynamics = arm.rigid_dynamics_model
    np.testing.assert_allclose(dynamics.masses, [7.0, 3.0, 3.0, 0.5])
    np.testing.assert_allclose(dynamics.centers_of_mass[1], [(2 * 0.5 + 1.5) / 3, 0.0, 0.25 / 3], atol=EXACT)


def test_shapes_hang_on_the_axis_that_moves_them(arm: UrdfRobotModel):
    shapes = {shape.name: shape for shape in arm.visualization.shapes}
    assert list(shapes) == ['upper/0', 'pole/stick', 'lower/0']
    box, stick, cube = shapes.values()
    assert box.geometry == Box((1.0, 0.1, 0.1))
    assert stick.geometry == Cylinder(0.1, 0.5)
    assert isinstance(cube.geometry, Mesh)
    np.testing.assert_allclose(np.ptp(cube.geometry.vertices, axis=0), 2.0)
    assert [shape.frame for shape in shapes.values()] == [1, 1, 2]
    np.testing.assert_allclose(box.pose.r, [0.5, 0.0, 0.0])
    np.testing.assert_allclose(stick.pose.r, [1.0, 0.0, 0.25])
    assert box.colour == (0.0, 1.0, 0.0, 0.5)
    assert cube.colour == (1.0, 0.0, 0.0, 1.0)
    (sphere,) = arm.collision_model.shapes
    assert sphere.geometry == Sphere(0.2)
    assert sphere.frame == 1


def test_home_is_zero_or_the_middle_of_the_range(arm: UrdfRobotModel):
    np.testing.assert_array_equal(arm.home, [1.0, 0.0, 0.0])


def test_name_is_the_urdfs_unless_given(arm: UrdfRobotModel, tmp_path: Path):
    assert arm.name == 'arm'
    assert UrdfRobotModel(write_arm(tmp_path), name='other').name == 'other'


def test_limits_file_beside_the_urdf_is_read(tmp_path: Path):
    (tmp_path / 'joint_limits.yaml').write_text('joint_limits: {two: {max_acceleration: 9}}')
    assert UrdfRobotModel(write_arm(tmp_path)).axes_data.acceleration[1] == 9.0


def test_part_of_the_chain_can_be_the_robot(tmp_path: Path):
    part = UrdfRobotModel(write_arm(tmp_path), base='upper', tip='hand')
    assert part.axes_data.names == ('two', 'three')
    r, _ = part.direct_kinematics(np.zeros(2))
    np.testing.assert_allclose(r, [2.0, 0.0, 0.0], atol=EXACT)
    np.testing.assert_allclose(part.rigid_dynamics_model.masses, [3.0, 3.0, 0.5])


@pytest.mark.parametrize('form', ['{}', 'file://{}', 'package://{package}/meshes/cube.stl'])
def test_meshes_are_found_however_they_are_named(tmp_path: Path, form: str):
    package = tmp_path / 'with space' / 'arm_description'
    path = package / 'meshes' / 'cube.stl'
    name = form.format(path, package=package.name).replace(' ', '%20' if '://' in form else ' ')
    robot = UrdfRobotModel(write_arm(package, mesh=name))
    assert len(robot.visualization.shapes) == 3
    assert path.as_uri() in robot.description


def test_mesh_of_an_installed_package_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'{tmp_path}/nowhere:{tmp_path}/prefix')
    write_arm(tmp_path / 'prefix' / 'share' / 'arm_description')
    robot = UrdfRobotModel(write_arm(tmp_path / 'here', mesh='package://arm_description/meshes/cube.stl'))
    assert len(robot.visualization.shapes) == 3


def test_shapes_on_demand_are_read_when_they_are_asked_for(tmp_path: Path):
    file = write_arm(tmp_path)
    robot = UrdfRobotModel(file, shapes_on_demand=True)
    (tmp_path / 'meshes' / 'cube.stl').write_text('nothing of a mesh')
    assert len(robot.collision_model.shapes) == 1
    with pytest.raises(UnknownRobotError, match='cannot be read'):
        _ = robot.visualization
    with pytest.raises(UnknownRobotError, match='not found'):
        UrdfRobotModel(write_arm(tmp_path, mesh='none.stl'), strict=True, shapes_on_demand=True)


def test_urdf_prefix_loads_any_file(tmp_path: Path):
    assert load_robot_model(f'urdf:{write_arm(tmp_path)}').num_axes == 3


def test_options_of_a_urdf_follow_its_path(tmp_path: Path):
    part = load_robot_model(f'urdf:{write_arm(tmp_path)}?base=upper&tip=hand&name=part')
    assert (part.name, part.axes_data.names) == ('part', ('two', 'three'))


def test_description_is_the_robot_alone_with_its_tool(tmp_path: Path):
    text = ARM.replace('tool0', 'gripper')
    part = UrdfRobotModel(write_arm(tmp_path, text=text), base='upper', tip='hand')
    again = tmp_path / 'again.urdf'
    again.write_text(part.description)
    whole = UrdfRobotModel(again)
    assert whole.axes_data.names == part.axes_data.names
    q = np.array([0.3, -0.2])
    for mine, its in zip(whole.direct_kinematics(q), part.direct_kinematics(q), strict=True):
        np.testing.assert_array_equal(mine, its)
    assert 'name="tool0"' in part.description
    assert 'name="base"' not in part.description


def test_description_has_the_limits_of_the_limits_file(tmp_path: Path):
    (tmp_path / 'joint_limits.yaml').write_text(
        'joint_limits: {two: {max_velocity: 0.25, max_effort: 7}, three: {min_position: -1, max_position: 2}}'
    )
    robot = UrdfRobotModel(write_arm(tmp_path))
    again = tmp_path / 'elsewhere' / 'again.urdf'
    again.parent.mkdir()
    again.write_text(robot.description)
    axes = UrdfRobotModel(again).axes_data
    np.testing.assert_array_equal(axes.velocity, [1.0, 0.25, 1.0])
    np.testing.assert_array_equal(axes.effort, [100.0, 7.0, 10.0])
    np.testing.assert_array_equal([axes.lower[2], axes.upper[2]], [-1.0, 2.0])


def test_joints_and_links_may_have_the_same_names(tmp_path: Path, arm: UrdfRobotModel):
    text = ARM.replace('"one"', '"upper"').replace('"two"', '"lower"').replace('"flange"', '"tool0"')
    robot = UrdfRobotModel(write_arm(tmp_path / 'same', text=text))
    assert robot.axes_data.names == ('upper', 'lower', 'three')
    q = np.array([0.7, -0.4, 1.1])
    for mine, its in zip(robot.direct_kinematics(q), arm.direct_kinematics(q), strict=True):
        np.testing.assert_array_equal(mine, its)
    assert [shape.frame for shape in robot.visualization.shapes] == [1, 1, 2]


def test_sliding_axis_moves_in_metres(tmp_path: Path):
    slide = ARM.replace('<joint name="two" type="revolute">', '<joint name="two" type="prismatic">')
    robot = UrdfRobotModel(write_arm(tmp_path, text=slide))
    assert robot.axes_data.prismatic == (False, True, False)
    low, _ = robot.direct_kinematics(np.array([1.0, 0.0, 0.0]))
    high, _ = robot.direct_kinematics(np.array([1.0, 0.5, 0.0]))
    np.testing.assert_allclose(high - low, [0.0, 0.0, 0.5], atol=EXACT)


def test_one_axis_is_a_robot(tmp_path: Path):
    robot = UrdfRobotModel(write_arm(tmp_path), tip='pole')
    q, q_dot = np.array([0.7]), np.array([-1.3])
    r, _ = robot.direct_kinematics(q)
    c, s = np.cos(0.7), np.sin(0.7)
    np.testing.assert_allclose(r, [c, s, 0.25], atol=EXACT)
    J, J_der = robot.jacobian(q), robot.jacobian_der(q, q_dot)
    np.testing.assert_allclose(J, np.array([[-s, c, 0.0, 0.0, 0.0, 1.0]]).T, atol=EXACT)
    np.testing.assert_allclose(J_der, -1.3 * np.array([[-c, -s, 0.0, 0.0, 0.0, 0.0]]).T, atol=EXACT)
    for mine, its in zip(robot.orientation_and_jacobians(q, q_dot)[1:], (J, J_der), strict=True):
        np.testing.assert_allclose(mine, its, atol=EXACT)
    tau, M, tau_aux = robot.rigid_dynamics(q, q_dot, q_dot)
    np.testing.assert_allclose(tau, M @ q_dot + tau_aux, atol=EXACT)
    assert M.shape == (1, 1)


@pytest.mark.parametrize('index', [0, 1, 2])
@pytest.mark.parametrize(
    'bad', [np.full(3, np.nan), np.array([0.0, np.inf, 0.0]), np.zeros(2), np.zeros((3, 1)), 'left', None]
)
def test_what_is_no_motion_is_refused_by_name(arm: UrdfRobotModel, index: int, bad: object):
    motion: list[Any] = [np.array([1.0, 0.3, 0.2])] * 3
    motion[index] = bad
    name = ('q', 'q_dot', 'q_ddot')[index]
    with pytest.raises(InvalidInputError, match=rf'^{name}\b(\[\d\] is| must)'):
        arm.rigid_dynamics(*motion)
    with pytest.raises(InvalidInputError, match=rf'^{name}\b(\[\d\] is| must)'):
        arm.rigid_dynamics_model.torques(*motion)
    if index < 2:
        for call in (arm.jacobian_der, arm.orientation_and_jacobians):
            with pytest.raises(InvalidInputError, match=rf'^{name}\b(\[\d\] is| must)'):
                call(*motion[:2])
    if index == 0:
        for call in (arm.direct_kinematics, arm.jacobian):
            with pytest.raises(InvalidInputError, match=r'^q\b(\[\d\] is| must)'):
                call(bad)


@pytest.mark.parametrize('tip', ['pole', 'tool0'])  # of one axis, of three
@pytest.mark.parametrize('index', [0, 1, 2])
def test_no_motion_of_sliding_axes_is_refused_by_name(tmp_path: Path, index: int, tip: str):
    slides = re.sub('type="(revolute|continuous)"', 'type="prismatic"', ARM)
    slides = slides.replace('<limit velocity', '<limit lower="-1" upper="1" velocity')
    robot = UrdfRobotModel(write_arm(tmp_path, text=slides), tip=tip)
    n = robot.num_axes
    assert all(robot.axes_data.prismatic)
    name = ('q', 'q_dot', 'q_ddot')[index]
    for axis in range(n):
        motion = np.zeros((3, n))
        motion[index, axis] = np.nan
        dynamics = NumericalDynamics(robot, friction=False)
        for call in (
            robot.rigid_dynamics,
            robot.rigid_dynamics_model.torques,
            dynamics.torques,
            dynamics.accelerations,
        ):
            with pytest.raises(InvalidInputError, match=rf'^{name}\[{axis}\] is nan'):
                call(*motion)


def test_gravity_can_be_chosen(tmp_path: Path):
    standing = ARM.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>')
    zero, q = np.zeros(3), np.array([1.0, 0.3, 0.2])
    earth, moon, orbit = (
        UrdfRobotModel(write_arm(tmp_path, text=standing), gravity=(0.0, 0.0, -g)) for g in (9.81, 1.62, 0.0)
    )
    tau = earth.rigid_dynamics(q, zero, zero)[2]
    assert np.abs(tau[:2]).min() > 1.0
    np.testing.assert_allclose(moon.rigid_dynamics(q, zero, zero)[2], tau * 1.62 / 9.81, rtol=1e-12)
    np.testing.assert_array_equal(orbit.rigid_dynamics(q, zero, zero)[2], 0.0)
    np.testing.assert_array_equal(orbit.rigid_dynamics(q, zero, q)[1], earth.rigid_dynamics(q, zero, q)[1])


def test_robot_without_masses_moves_and_weighs_nothing(tmp_path: Path, arm: UrdfRobotModel):
    massless = re.sub('<inertial>.*?</inertial>', '', ARM)
    robot = UrdfRobotModel(write_arm(tmp_path / 'massless', text=massless))
    q = np.array([0.7, -0.4, 1.1])
    np.testing.assert_array_equal(robot.direct_kinematics(q)[0], arm.direct_kinematics(q)[0])
    for result in robot.rigid_dynamics(q, q, q):
        np.testing.assert_array_equal(result, 0.0)


def test_mesh_that_says_its_unit_is_as_large_as_it_says(tmp_path: Path):
    dae = trimesh.creation.box((500.0, 500.0, 500.0)).export(file_type='dae').decode()
    (tmp_path / 'mm.dae').write_text(
        dae.replace('<asset>', '<asset><unit name="millimeter" meter="0.001"/>', 1)
    )
    robot = UrdfRobotModel(write_arm(tmp_path, mesh='mm.dae'))
    (cube,) = (shape.geometry for shape in robot.visualization.shapes if isinstance(shape.geometry, Mesh))
    np.testing.assert_allclose(np.ptp(cube.vertices, axis=0), 1.0)  # the URDF's scale is 2


def test_positions_of_any_layout_give_the_same_pose():
    robot = load_robot_model('kuka_kr210_r2700')
    q = np.random.default_rng(4).uniform(robot.axes_data.lower, robot.axes_data.upper)
    r, T = robot.direct_kinematics(q)
    frozen = q.copy()
    frozen.flags.writeable = False
    layouts = (frozen, np.repeat(q, 2)[::2], q[::-1].copy()[::-1], q.tolist(), q.astype('>f8'))
    for same in layouts:
        found_r, found_T = robot.direct_kinematics(same)
        np.testing.assert_array_equal(found_r, r)
        np.testing.assert_array_equal(found_T, T)


@pytest.mark.parametrize('copied', [copy.copy, copy.deepcopy])
def test_a_copy_has_memory_of_its_own(
    arm: UrdfRobotModel, copied: Callable[[UrdfRobotModel], UrdfRobotModel]
):
    first, second = np.array([1.0, 0.3, 0.2]), np.array([-0.5, 0.7, 1.1])
    expected = arm.direct_kinematics(first), arm.direct_kinematics(second)
    twin = copied(arm)
    for robot, other in ((arm, twin), (twin, arm)):
        other.direct_kinematics(second)
        for mine, its in zip(robot.direct_kinematics(first), expected[0], strict=True):
            np.testing.assert_array_equal(mine, its)
        for mine, its in zip(robot.direct_kinematics(second), expected[1], strict=True):
            np.testing.assert_array_equal(mine, its)

"""URDFs as makers publish them: what they lack is substituted, and said; nothing of it with strict=true."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from robots_core import Pose, UrdfRobotModel, load_robot_model
from robots_core.blocks import CollisionDetection
from robots_core.blocks.collision.allowed_pair_sampling import allowed_pairs_of
from robots_core.blocks.collision.solids import solids_of
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.errors import InvalidInputError, JointLimitError, UnknownRobotError
from robots_core.files.content_cache import cache_folder
from robots_core.robot_model.shapes import Cylinder, Mesh, Sphere
from robots_core.robot_model.urdf.outer_hull import EXCESS, outer_hull

NO_LIMITS = 'velocity="0" effort="0"'
MESH = '<geometry><mesh filename="package://arm_support/meshes/{}"/></geometry>'
MASS = '<inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
# Axes as those of most robots in industry: one upright, two across, three of the wrist.
AXES = ('0 0 1', '0 1 0', '0 -1 0', '-1 0 0', '0 -1 0', '-1 0 0')
OFFSETS = ('0 0 0.3', '0.1 0 0.2', '0 0 0.6', '0.3 0 0.1', '0.3 0 0', '0.1 0 0')


def arm_xml(*, limits: str = 'velocity="2" effort="90"', inside: str = '') -> str:
    links = ''.join(f'<link name="link_{k}">{inside.format(k)}</link>' for k in range(7))
    joints = ''.join(
        f'<joint name="joint_{k + 1}" type="revolute"><parent link="link_{k}"/><child link="link_{k + 1}"/>'
        f'<origin xyz="{offset}"/><axis xyz="{axis}"/><limit lower="-2" upper="2" {limits}/></joint>'
        for k, (axis, offset) in enumerate(zip(AXES, OFFSETS, strict=True))
    )
    return f'<robot name="arm">{links}{joints}</robot>'


def write(folder: Path, xml: str, name: str = 'arm.urdf') -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / name
    file.write_text(xml)
    return file


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))


def test_limits_of_zero_are_unknown_and_substituted_once(tmp_path: Path):
    robot = UrdfRobotModel(write(tmp_path, arm_xml(limits=NO_LIMITS)))
    assert (robot.axes_data.velocity == np.pi / 2).all()
    assert (robot.axes_data.effort == 1000.0).all()
    speed, effort = robot.substitutions
    assert 'joint_1, joint_2, joint_3, joint_4, joint_5, joint_6: no velocity limit above 0' in speed
    assert '90 degrees/s' in speed
    assert '1000 N m' in effort
    assert 'effort="1000.0"' in robot.description


def test_unknown_efforts_carry_the_robot_where_its_masses_are_known(tmp_path: Path):
    file = write(tmp_path, arm_xml(limits='velocity="2" effort="0"', inside=MASS.format(20)))
    robot = UrdfRobotModel(file)
    axes = robot.axes_data
    random = np.random.default_rng(3)
    for _ in range(50):
        q = random.uniform(axes.lower, axes.upper)
        tau, _, _ = robot.rigid_dynamics(q, np.zeros(6), np.zeros(6))
        assert (np.abs(tau) <= axes.effort).all()
    assert '1.5 times what the robot itself needs' in robot.substitutions[0]


def test_a_limit_below_zero_is_refused(tmp_path: Path):
    with pytest.raises(InvalidInputError, match='effort limit -1 must be a finite number above 0'):
        UrdfRobotModel(write(tmp_path, arm_xml(limits='velocity="2" effort="-1"')))


def test_links_without_meshes_are_bodies_between_their_joints(tmp_path: Path):
    both = ''.join(f'<{kind}>{MESH.format("{0}.stl")}</{kind}>' for kind in ('visual', 'collision'))
    robot = UrdfRobotModel(write(tmp_path, arm_xml(inside=both)))
    for shapes in (robot.visualization.shapes, robot.collision_model.shapes):
        assert [type(shape.geometry) for shape in shapes] == [*(6 * [Cylinder]), Sphere]
        # Of the link between joints 3 and 4, in the frame of joint 3: its ends are both joints.
        body = shapes[3]
        assert isinstance(body.geometry, Cylinder)
        along = 0.5 * body.geometry.length * body.pose.T[:, 2]
        np.testing.assert_allclose(body.pose.r - along, [0.0, 0.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(body.pose.r + along, [0.3, 0.0, 0.1], atol=1e-12)
    (sentence,) = robot.substitutions
    assert sentence.startswith(
        "14 mesh files are missing: there is no mesh file 'package://arm_support/meshes"
    )
    assert 'AMENT_PREFIX_PATH and ROS_PACKAGE_PATH' in sentence
    assert not CollisionDetection(robot).in_contact(robot.home)


def test_the_other_mesh_of_a_link_goes_before_a_simple_body(tmp_path: Path):
    (tmp_path / 'meshes').mkdir()
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / 'meshes' / 'box.stl')
    inside = f'<visual>{MESH.format("{0}.dae")}</visual><collision>{MESH.format("box.stl")}</collision>'
    robot = UrdfRobotModel(write(tmp_path, arm_xml(inside=inside)))
    assert all(isinstance(shape.geometry, Mesh) for shape in robot.visualization.shapes)
    assert 'the other mesh of link_0, link_1' in robot.substitutions[0]


@pytest.mark.parametrize('where', ['AMENT_PREFIX_PATH', 'ROS_PACKAGE_PATH', 'beside', 'package.xml'])
def test_packages_are_searched_everywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str):
    urdf = tmp_path / 'here' / 'urdf'
    place = {
        'AMENT_PREFIX_PATH': tmp_path / 'prefix' / 'share' / 'arm_support',
        'ROS_PACKAGE_PATH': tmp_path / 'sources' / 'arm_support',
        'beside': urdf,
        'package.xml': tmp_path / 'here',
    }[where]
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(tmp_path / 'prefix'))
    monkeypatch.setenv('ROS_PACKAGE_PATH', f'{tmp_path}/nowhere:{tmp_path}/sources')
    (place / 'meshes').mkdir(parents=True)
    if where == 'package.xml':
        (place / 'package.xml').write_text('<package><name>arm_support</name></package>')
    trimesh.creation.box((0.1, 0.1, 0.1)).export(place / 'meshes' / 'box.stl')
    inside = ''.join(f'<{kind}>{MESH.format("box.stl")}</{kind}>' for kind in ('visual', 'collision'))
    robot = UrdfRobotModel(write(urdf, arm_xml(inside=inside)))
    assert robot.substitutions == ()
    assert (place / 'meshes' / 'box.stl').as_uri() in robot.description


@pytest.mark.parametrize(
    ('xml', 'message'),
    [
        (arm_xml(limits=NO_LIMITS), 'joint_6: no velocity limit above 0'),
        (arm_xml(limits='velocity="1" effort="0"'), 'no effort limit above 0'),
        (arm_xml(inside=f'<visual>{MESH.format("{0}.stl")}</visual>'), r"0\.stl' not found beside or below"),
    ],
)
def test_strict_substitutes_nothing(tmp_path: Path, xml: str, message: str):
    file = write(tmp_path, xml)
    with pytest.raises(UnknownRobotError, match=message):
        load_robot_model(f'urdf:{file}?strict=true')
    assert load_robot_model(f'urdf:{file}?strict=false').substitutions
    with pytest.raises(InvalidInputError, match="strict = 'yes' must be true or false"):
        load_robot_model(f'urdf:{file}?strict=yes')


def test_a_limits_file_of_another_format_is_left_out(tmp_path: Path):
    file = write(tmp_path, arm_xml())
    (tmp_path / 'joint_limits.yaml').write_text('joint1: {limit: {lower: -1}}')
    (sentence,) = UrdfRobotModel(file).substitutions
    assert 'joint_limits.yaml beside the URDF has no mapping joint_limits' in sentence
    with pytest.raises(UnknownRobotError, match='no mapping joint_limits'):
        UrdfRobotModel(file, strict=True)


def test_home_is_not_singular_by_default(tmp_path: Path):
    """At zero the axes of joints 4 and 6 are one line."""
    robot = UrdfRobotModel(write(tmp_path, arm_xml()))
    smallest = [np.linalg.svd(robot.jacobian(q), compute_uv=False)[-1] for q in (np.zeros(6), robot.home)]
    assert smallest[0] < 1e-12  # rounding
    assert smallest[1] > 0.05
    assert np.count_nonzero(robot.home) == 1


def test_home_is_not_in_contact_by_default(tmp_path: Path):
    """A ball on the last link would be inside of the pole on the first one."""
    ball = '<collision><geometry><sphere radius="0.05"/></geometry></collision>'
    pole = '<collision><origin xyz="0.8 0 1.2"/><geometry><sphere radius="0.3"/></geometry></collision>'
    xml = arm_xml().replace('<link name="link_6"/>', f'<link name="link_6">{ball}</link>')
    xml = xml.replace('<link name="link_6"></link>', f'<link name="link_6">{ball}</link>')
    xml = xml.replace('<link name="link_0"></link>', f'<link name="link_0">{pole}</link>')
    robot = UrdfRobotModel(write(tmp_path, xml))
    detection = CollisionDetection(robot)
    assert detection.in_contact(np.zeros(6))
    assert not detection.in_contact(robot.home)


def test_home_can_be_given_in_the_name(tmp_path: Path):
    file = write(tmp_path, arm_xml())
    robot = load_robot_model(f'urdf:{file}?home=0,-1.57,1.57,0,0.5,0')
    np.testing.assert_array_equal(robot.home, [0.0, -1.57, 1.57, 0.0, 0.5, 0.0])
    with pytest.raises(JointLimitError, match='joint_2 = -90 rad'):
        load_robot_model(f'urdf:{file}?home=0,-90,90,0,0,0')


def test_detailed_meshes_are_checked_by_convex_bodies_around_them(tmp_path: Path):
    ring = trimesh.creation.annulus(0.05, 0.1, 0.2, sections=256)
    (tmp_path / 'meshes').mkdir()
    ring.export(tmp_path / 'meshes' / 'ring.stl')
    file = write(tmp_path, arm_xml(inside=f'<collision>{MESH.format("ring.stl")}</collision>'))
    hull = UrdfRobotModel(file).collision_model.shapes[0].geometry
    assert isinstance(hull, Mesh)
    around = trimesh.Trimesh(hull.vertices, hull.faces)
    assert around.is_convex
    assert len(hull.faces) < 200
    # None of the ring is outside, by more than the rounding of corners.
    assert trimesh.proximity.signed_distance(around, ring.vertices).min() > -1e-5
    assert np.linalg.norm(hull.vertices[:, :2], axis=1).max() < 0.1 + 3.0 * EXCESS
    assert list(cache_folder().glob('outer_hull-*.npz'))
    exact = load_robot_model(f'urdf:{file}?hulls=false').collision_model.shapes[0].geometry
    assert isinstance(exact, Mesh)
    assert len(exact.faces) == len(ring.faces)


def test_what_is_kept_is_found_again_and_damage_is_mended(tmp_path: Path):
    (tmp_path / 'meshes').mkdir()
    trimesh.creation.icosphere(4, 0.1).export(tmp_path / 'meshes' / 'ball.stl')
    file = write(tmp_path, arm_xml(inside=f'<collision>{MESH.format("ball.stl")}</collision>'))
    first = CollisionDetection(UrdfRobotModel(file)).allowed_pairs
    (pairs,) = cache_folder().glob('allowed_pairs-*.npz')
    written = pairs.stat().st_mtime_ns
    assert CollisionDetection(UrdfRobotModel(file)).allowed_pairs.reasons == first.reasons
    assert pairs.stat().st_mtime_ns == written
    pairs.write_text('damaged')
    assert CollisionDetection(UrdfRobotModel(file)).allowed_pairs.reasons == first.reasons


@pytest.mark.parametrize('sides', [(0.1, 0.2, 0.3), (0.3, 0.3, 0.3)])
def test_the_body_around_a_mesh_counts_as_convex(sides: tuple[float, float, float]):
    """Many planes meet in the corners of a box; a sliver there would make a slow surface of it."""
    box = trimesh.creation.box(sides)
    for turn in (np.eye(3), trimesh.transformations.euler_matrix(0.3, 0.5, 0.7)[:3, :3]):
        fine = trimesh.Trimesh(box.vertices @ turn.T, box.faces).subdivide().subdivide().subdivide()
        hull = outer_hull(Mesh(fine.vertices, fine.faces))
        assert [one.convex for one in solids_of('box', hull, 0, Pose(np.zeros(3), np.eye(3)))] == [True]


def test_flat_mesh_has_no_body_around_it():
    flat = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]), np.array([[0, 1, 2], [1, 3, 2]]))
    assert outer_hull(flat) is flat


XACRO = (
    '<robot name="made" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="reach" default="0.5"/>'
    '<xacro:include filename="$(find arm_support)/parts.xacro"/><xacro:part length="$(arg reach)"/></robot>'
)
PARTS = (
    '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="part" params="length">'
    '<link name="a"/><link name="b"/><link name="tool0"/><joint name="turn" type="revolute">'
    '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
    '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
    '<joint name="end" type="fixed"><parent link="b"/><child link="tool0"/>'
    '<origin xyz="${length} 0 0"/></joint>'
    '</xacro:macro></robot>'
)


def test_xacro_files_are_expanded_with_their_arguments(tmp_path: Path):
    write(tmp_path / 'arm_support', PARTS, 'parts.xacro')
    file = write(tmp_path / 'arm_support' / 'urdf', XACRO, 'made.urdf.xacro')
    for name, reach in ((f'xacro:{file}', 0.5), (f'xacro:{file}?reach=0.7&base=b', None)):
        if reach is not None:
            np.testing.assert_allclose(
                load_robot_model(name).direct_kinematics(np.zeros(1))[0], [reach, 0, 0]
            )
    longer = load_robot_model(f'xacro:{file}?reach=0.7&name=mine')
    assert longer.name == 'mine'
    np.testing.assert_allclose(longer.direct_kinematics(np.zeros(1))[0], [0.7, 0, 0])
    with pytest.raises(UnknownRobotError, match="no argument 'raech'; did you mean 'reach'"):
        load_robot_model(f'xacro:{file}?raech=1')
    (tmp_path / 'arm_support' / 'parts.xacro').unlink()
    with pytest.raises(UnknownRobotError, match=r'made\.urdf\.xacro cannot be expanded by xacro'):
        load_robot_model(f'xacro:{file}')


def test_a_xacro_file_loaded_as_urdf_is_refused_with_the_way_to_load_it(tmp_path: Path):
    with pytest.raises(UnknownRobotError, match='load it by the name xacro:'):
        UrdfRobotModel(write(tmp_path, XACRO))


@pytest.mark.parametrize(
    ('content', 'why'),
    [('', 'holds no triangles'), ('version https://git-lfs.github.com/spec/v1\noid 1', 'run git lfs pull')],
)
def test_meshes_that_cannot_be_read_are_substituted_as_missing_ones(tmp_path: Path, content: str, why: str):
    write(tmp_path / 'arm_support' / 'meshes', content, '2.stl')
    inside = ''.join(f'<{kind}>{MESH.format("2.stl")}</{kind}>' for kind in ('visual', 'collision'))
    xml = arm_xml().replace('<link name="link_2"></link>', f'<link name="link_2">{inside}</link>')
    file = write(tmp_path / 'arm_support' / 'urdf', xml)
    robot = UrdfRobotModel(file)
    assert isinstance(robot.visualization.shapes[0].geometry, Cylinder)
    (sentence,) = robot.substitutions
    assert why in sentence
    assert 'cylinders and spheres' in sentence
    with pytest.raises(UnknownRobotError, match=why):
        UrdfRobotModel(file, strict=True)


def test_efforts_that_do_not_carry_the_robot_are_substituted(tmp_path: Path):
    weak = arm_xml(limits='velocity="2" effort="30"', inside=MASS.format(20))
    robot = UrdfRobotModel(write(tmp_path, weak))
    assert robot.axes_data.effort[1] > 500.0
    assert 'does not carry the robot itself' in robot.substitutions[0]
    strong = arm_xml(limits='velocity="2" effort="3000"', inside=MASS.format(20))
    assert UrdfRobotModel(write(tmp_path, strong)).substitutions == ()


@pytest.mark.parametrize(('gap', 'checked'), [(0.004, 0), (0.01, 1)])
def test_links_that_are_always_nearer_than_planners_keep_clear_are_not_checked(
    tmp_path: Path, gap: float, checked: int
):
    body = '<collision><origin xyz="0 0 {}"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
    heights = {0: 0.0, 2: 0.1 + gap}
    links = ''.join(
        f'<link name="link_{k}">{body.format(heights[k]) if k in heights else ""}</link>' for k in range(4)
    )
    joints = ''.join(
        f'<joint name="joint_{k}" type="revolute"><parent link="link_{k}"/><child link="link_{k + 1}"/>'
        f'<axis xyz="{axis}"/><limit lower="-2" upper="2" velocity="2" effort="90"/></joint>'
        for k, axis in enumerate(('0 0 1', '0 0 1', '0 1 0'))
    )
    robot = UrdfRobotModel(write(tmp_path, f'<robot name="arm">{links}{joints}</robot>'))
    pairs = allowed_pairs_of(robot)
    assert (pairs.reasons.get(('link_0/0', 'link_2/0')) != 'always') == checked


def test_unused_xacro_properties_in_a_urdf_are_left_out(tmp_path: Path):
    xml = arm_xml().replace(
        '<robot name="arm">',
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="w" value="1"/>',
    )
    assert UrdfRobotModel(write(tmp_path, xml)).num_axes == 6
    with pytest.raises(UnknownRobotError, match='not a URDF but a xacro file'):
        UrdfRobotModel(write(tmp_path, xml.replace('upper="2"', 'upper="${w}"')))


def test_a_robot_without_collision_shapes_collides_with_what_is_shown(tmp_path: Path):
    body = '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
    file = write(tmp_path, arm_xml(inside=body))
    robot = UrdfRobotModel(file)
    assert len(robot.collision_model.shapes) == len(robot.visualization.shapes) == 7
    assert robot.substitutions == (
        'no link has a <collision>; taken in its place: what is shown by <visual>',
    )


def test_rigid_body_drives_refuse_a_robot_without_masses(tmp_path: Path):
    robot = UrdfRobotModel(write(tmp_path, arm_xml()))
    with pytest.raises(InvalidInputError, match=r"'arm' has no masses.*no <inertial>.*second_order or ideal"):
        drive_train('rigid_body', robot, robot.home, period=0.004)


def with_base(joint: str) -> str:
    return arm_xml().replace('</robot>', f'<link name="base"/>{joint}</robot>')


FIXED_BASE = '<joint name="to_base" type="fixed"><parent link="{}"/><child link="base"/><origin {}/></joint>'


@pytest.mark.parametrize(
    ('parent', 'origin', 'where'),
    [
        (
            'link_0',
            'rpy="0 0 3.14159265358979"',
            'lies at (0, 0, 0) m and turned by 3.142 rad, seen from link_0',
        ),
        ('link_0', 'xyz="0 0.1 -0.25"', 'lies at (0, 0.1, -0.25) m and turned by 0 rad, seen from link_0'),
        ('link_2', 'xyz="0 0 0"', 'moves with joint_2'),
    ],
)
def test_a_link_base_that_lies_elsewhere_is_named(tmp_path: Path, parent: str, origin: str, where: str):
    file = write(tmp_path, with_base(FIXED_BASE.format(parent, origin)))
    (sentence,) = UrdfRobotModel(file).substitutions
    assert sentence == (
        f'link base {where}; it would have to be the root, or lie where that does; taken in its place: '
        'link_0, to which poses in frame base refer'
    )
    with pytest.raises(UnknownRobotError, match=r'link base (lies|moves)'):
        UrdfRobotModel(file, strict=True)


def test_a_link_base_that_lies_in_the_root_is_the_base(tmp_path: Path):
    at_root = with_base(FIXED_BASE.format('link_0', 'xyz="0 0 1e-9"'))
    assert UrdfRobotModel(write(tmp_path, at_root)).substitutions == ()
    xml = arm_xml().replace('link_0', 'base')
    assert UrdfRobotModel(write(tmp_path, xml)).substitutions == ()

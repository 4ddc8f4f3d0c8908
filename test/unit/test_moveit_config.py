"""The configuration of MoveIt agrees with the robot."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from lxml import etree

from robots_core import available_robot_models, load_robot_model
from robots_core.blocks import CollisionDetection
from robots_core.exit_codes import ExitCode
from robots_core.moveit_config import ACTION, moveit_files, run
from robots_planning.nodes import follow_joint_trajectory


@pytest.mark.parametrize('name', available_robot_models())
def test_the_files_say_what_the_robot_does(name: str):
    robot = load_robot_model(name)
    files = moveit_files(robot)
    urdf, srdf = (etree.fromstring(files[f'{name}.{kind}'].encode()) for kind in ('urdf', 'srdf'))
    assert urdf.get('name') == srdf.get('name') == name
    links = {link.get('name') for link in urdf.findall('link')}
    chain = srdf.find('group/chain')
    assert chain is not None
    assert {chain.get('base_link'), chain.get('tip_link')} <= links
    state = {
        joint.get('name'): float(joint.get('value', 'nan')) for joint in srdf.iterfind('group_state/joint')
    }
    assert state == dict(zip(robot.axes_data.names, robot.home, strict=True))

    limits = yaml.safe_load(files['joint_limits.yaml'])['joint_limits']
    for axis, (joint, found) in enumerate(limits.items()):
        assert joint == robot.axes_data.names[axis]
        assert found == {
            'has_velocity_limits': True,
            'max_velocity': robot.axes_data.velocity[axis],
            'has_acceleration_limits': True,
            'max_acceleration': robot.axes_data.acceleration[axis],
            'has_jerk_limits': True,
            'max_jerk': robot.axes_data.jerk[axis],
        }
    (group,) = yaml.safe_load(files['kinematics.yaml']).values()
    assert ('position_only_ik' in group) == (robot.num_axes < 6)

    controllers = yaml.safe_load(files['moveit_controllers.yaml'])['moveit_simple_controller_manager']
    (controller,) = (controllers[one] for one in controllers['controller_names'])
    # MoveIt calls the action controller/action_ns, or by the controller's name alone.
    assert controllers['controller_names'] == [ACTION] == [follow_joint_trajectory.ACTION]
    assert controller['action_ns'] == ''
    assert controller['joints'] == list(robot.axes_data.names)


@pytest.mark.parametrize('name', available_robot_models())
def test_pairs_of_links_are_checked_where_one_of_their_shapes_is(name: str):
    robot = load_robot_model(name)
    srdf = etree.fromstring(moveit_files(robot)[f'{name}.srdf'].encode())
    omitted = {frozenset((one.get('link1'), one.get('link2'))) for one in srdf.iterfind('disable_collisions')}
    near = CollisionDetection(robot).distances(robot.home, 1e3)
    checked = {frozenset(shape.rpartition('/')[0] for shape in (pair.first, pair.second)) for pair in near}
    links = {shape.name.rpartition('/')[0] for shape in robot.collision_model.shapes}
    every = {frozenset((one, other)) for one in links for other in links if one != other}
    assert checked == every - omitted
    assert {one.get('reason') for one in srdf.iterfind('disable_collisions')} <= {
        'Adjacent',
        'Never',
        'Default',
    }


def test_the_command_writes_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    folder = tmp_path / 'moveit'
    assert run(['--robot', 'ur5e', '--output', str(folder)]) == ExitCode.OK
    names = ['joint_limits.yaml', 'kinematics.yaml', 'moveit_controllers.yaml', 'ur5e.srdf', 'ur5e.urdf']
    assert sorted(path.name for path in folder.iterdir()) == names
    assert str(folder / 'ur5e.srdf') in capsys.readouterr().out


@pytest.mark.parametrize(
    ('arguments', 'message'),
    [
        (['--robot', 'ur5'], "unknown robot 'ur5'; did you mean 'ur5e'?"),
        (['--robot', 'ur5e', '--output', __file__], __file__),
    ],
)
def test_mistakes(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]):
    assert run(arguments) == ExitCode.BAD_INPUT
    assert message in capsys.readouterr().err

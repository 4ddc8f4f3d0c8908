"""moveit_config: what MoveIt needs to plan for a robot of the suite that moves in a cell."""

import argparse
import sys
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any, Final, NoReturn

import yaml
from lxml import etree

from robots_core.blocks.collision.allowed_pair_sampling import allowed_pairs_of
from robots_core.errors import RobotsError, UnreadableFileError
from robots_core.exit_codes import ExitCode
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel

GROUP: Final = 'manipulator'
TIP: Final = 'tool0'
ACTION: Final = 'follow_joint_trajectory'
"""Of planning_node, in the namespace of the cell."""

_HEADER: Final = '# Made by `moveit_config`.\n'


def moveit_files(robot: BaseRobotModel) -> dict[str, str]:
    """Contents of the files, by their names: the robot, and parameters of MoveIt's `move_group`."""
    name = str(etree.fromstring(robot.description.encode()).get('name'))
    return {
        f'{name}.urdf': robot.description,
        f'{name}.srdf': _semantics(robot, name),
        'joint_limits.yaml': _yaml({'joint_limits': _limits(robot)}),
        'kinematics.yaml': _yaml({GROUP: _solver(robot)}),
        'moveit_controllers.yaml': _yaml(_controllers(robot)),
    }


def _semantics(robot: BaseRobotModel, name: str) -> str:
    """SRDF: one group, the home position, and the pairs of links that never need a collision check."""
    description = etree.fromstring(robot.description.encode())
    children = {joint.find('child').get('link') for joint in description.findall('joint')}
    root = next(link.get('name') for link in description.findall('link') if link.get('name') not in children)
    semantics = etree.Element('robot', name=name)
    group = etree.SubElement(semantics, 'group', name=GROUP)
    etree.SubElement(group, 'chain', base_link=str(root), tip_link=TIP)
    home = etree.SubElement(semantics, 'group_state', name='home', group=GROUP)
    for joint, value in zip(robot.axes_data.names, robot.home.tolist(), strict=True):
        etree.SubElement(home, 'joint', name=joint, value=repr(value))
    for (first, second), reason in _apart(robot).items():
        etree.SubElement(semantics, 'disable_collisions', link1=first, link2=second, reason=reason)
    etree.indent(semantics)
    return str(etree.tostring(semantics, encoding='unicode')) + '\n'


def _apart(robot: BaseRobotModel) -> dict[tuple[str, str], str]:
    """Pairs of links none of whose shapes need a check, with MoveIt's name of the reason."""
    allowed = allowed_pairs_of(robot)
    links: dict[str, list[str]] = {}
    frames: dict[str, int] = {}
    for shape in robot.collision_model.shapes:
        link = shape.name.rpartition('/')[0]
        links.setdefault(link, []).append(shape.name)
        frames[link] = shape.frame
    found = {}
    for first, second in combinations(links, 2):
        pairs = [tuple(sorted((one, other))) for one in links[first] for other in links[second]]
        reasons = {allowed.reasons.get((one, other), '') for one, other in pairs}
        if frames[first] == frames[second]:
            found[first, second] = 'Adjacent'  # one body
        elif '' not in reasons:
            found[first, second] = (
                'Default' if 'always' in reasons else 'Adjacent' if 'adjacent' in reasons else 'Never'
            )
    return found


def _limits(robot: BaseRobotModel) -> dict[str, Any]:
    axes = robot.axes_data
    return {
        name: {
            f'{has}_{kind}{ending}': value
            for kind, limits in (
                ('velocity', axes.velocity),
                ('acceleration', axes.acceleration),
                ('jerk', axes.jerk),
            )
            for has, ending, value in (('has', '_limits', True), ('max', '', float(limits[axis])))
        }
        for axis, name in enumerate(axes.names)
    }


def _solver(robot: BaseRobotModel) -> dict[str, Any]:
    solver: dict[str, Any] = {
        'kinematics_solver': 'kdl_kinematics_plugin/KDLKinematicsPlugin',
        'kinematics_solver_search_resolution': 0.005,
        'kinematics_solver_timeout': 0.05,
    }
    # Fewer axes cannot reach every orientation.
    return solver | ({'position_only_ik': True} if robot.num_axes < 6 else {})


def _controllers(robot: BaseRobotModel) -> dict[str, Any]:
    """The action's name is that of its controller, and the namespace below it, which is empty here."""
    controller = {
        'type': 'FollowJointTrajectory',
        'action_ns': '',
        'default': True,
        'joints': list(robot.axes_data.names),
    }
    manager = 'moveit_simple_controller_manager'
    return {
        'moveit_manage_controllers': False,  # they are not of ros2_control
        'moveit_controller_manager': f'{manager}/MoveItSimpleControllerManager',
        manager: {'controller_names': [ACTION], ACTION: controller},
    }


def _yaml(content: dict[str, Any]) -> str:
    return _HEADER + yaml.safe_dump(content, sort_keys=False)


def write_moveit_files(robot: BaseRobotModel, folder: Path) -> list[Path]:
    """Write the files of `moveit_files`, in the place of older ones.

    Raises:
        UnreadableFileError: the folder cannot be written.
    """
    paths = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in moveit_files(robot).items():
            paths.append(folder / name)
            paths[-1].write_text(text, encoding='utf-8')
    except OSError as error:
        raise UnreadableFileError(f'{folder} cannot be written: {error.strerror}') from error
    return paths


def main() -> NoReturn:
    """Run from the command line."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Write the files for the robot of a command line, and print their names; returns an exit code."""
    parser = argparse.ArgumentParser(
        prog='moveit_config',
        description='Write URDF, SRDF, limits, kinematics and controllers of a robot for MoveIt 2.',
    )
    parser.add_argument(
        '--robot', required=True, metavar='NAME', help='name of a robot, or urdf:/path/to/robot.urdf'
    )
    parser.add_argument(
        '-o',
        '--output',
        type=Path,
        metavar='FOLDER',
        help='folder for the files; moveit_ROBOT by default',
    )
    options = parser.parse_args(arguments)
    try:
        robot = load_robot_model(options.robot)
        for path in write_moveit_files(robot, options.output or Path(f'moveit_{robot.name}')):
            print(path)
    except RobotsError as error:
        print(error.line_for_person, file=sys.stderr)
        return ExitCode.BAD_INPUT
    return ExitCode.OK

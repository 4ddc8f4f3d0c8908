"""ros2 launch robots_controller cell.launch.py program:=... robot:=... scene:=... io:=... io_map:=..."""

import json
import subprocess
import sys
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription

ARGUMENTS = {
    'robot': ('', "the robot's name"),
    'program': ('', 'Lua robot program to run'),
    'scene': ('', 'scene to keep clear of (YAML)'),
    'drive': ('second_order', 'level of detail of the simulated drives: `cell --help` lists them'),
    'driver': ('', 'driver of a real robot, in the place of simulated drives (YAML)'),
    'guided': ('', 'inverse kinematics that follows reference_pose'),
    'watchdog': ('0.2', 'longest time without a sign of life, s; no certified safety function'),
    'operating_mode': ('AUTOMATIC', 'AUTOMATIC, T1, T2 or REMOTE; no certified safety function'),
    'tool_speed_limit': ('0.0', 'of tool and axes, m/s; 0 for none; no certified safety function'),
    'rate': ('250', 'references per second, Hz'),
    'goal_tolerance': ('', 'largest error of an axis at its target, rad; by default that of the controller'),
    'port': ('8080', "first port to try for the browser's page"),
    'debug_port': ('0', 'port for editors; 0 for none'),
    'opcua': ('0', 'TCP port at which the robot is an OPC UA server; 0 for none'),
    'opcua_access': ('', 'YAML file that says who may do what at the OPC UA server'),
    'io': ('', 'YAML script of a PLC that is played'),
    'frames': ('', 'tools and bases by name (YAML); frames.yaml beside the program by default'),
    'io_map': ('', 'YAML map to topics of a PLC, or to Modbus, MQTT and OPC UA'),
}
"""Options of `cell`: their defaults, and what they mean."""

LAUNCH_ARGUMENTS = {
    'namespace': ('', 'namespace of all nodes'),
    'composed': ('false', 'true: all nodes but controller_node and drive_node share a process'),
    'headless': ('false', 'true: no 3D view of the robot'),
    'record': ('', 'folder of a bag of all topics, which must not exist yet'),
    'rviz': ('false', 'true: show the robot in RViz'),
}
"""Further arguments."""
SWITCHES = ('composed', 'headless')
"""Those that are options of `cell` without a value."""


def refuse_unknown(arguments: list[str]) -> None:
    """Refuse arguments of `ros2 launch` for this file that it does not have; launch itself ignores them.

    Raises:
        RuntimeError: there is one.
    """
    if not any(argument.endswith(Path(__file__).name) for argument in arguments):
        return  # another launch file includes this one, and has arguments of its own
    known = [*ARGUMENTS, *LAUNCH_ARGUMENTS]
    for argument in arguments:
        name, given, _ = argument.partition(':=')
        if given and name not in known:
            close = get_close_matches(name, known, 1)
            hint = f'did you mean {close[0]!r}?' if close else f'there are {", ".join(known)}'
            raise RuntimeError(f'there is no launch argument {name!r}; {hint}')


def nodes(context: LaunchContext) -> list[Any]:
    """The nodes of the cell, from the same description that `cell` uses.

    `cell` describes them itself: `ros2` runs on the system's Python, which does not have what the package
    needs.
    """
    refuse_unknown(sys.argv)
    cell = Path(get_package_prefix('robots_controller'), 'lib', 'robots_controller', 'cell')
    command = [str(cell), '--describe']
    for name in ARGUMENTS:
        if value := LaunchConfiguration(name).perform(context):
            command += ['--' + name.replace('_', '-'), value]
    for name in SWITCHES:
        if LaunchConfiguration(name).perform(context) == 'true':
            command.append('--' + name)
    described = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    if described.returncode:
        raise RuntimeError(described.stderr.strip())
    namespace = LaunchConfiguration('namespace').perform(context)
    processes: dict[str, list[dict[str, Any]]] = {}
    for node in json.loads(described.stdout):
        processes.setdefault(node['process'], []).append(node)
    started = [process(nodes, namespace) for nodes in processes.values()]
    if record := LaunchConfiguration('record').perform(context):
        started.append(ExecuteProcess(cmd=['ros2', 'bag', 'record', '--all', '--output', record]))
    if LaunchConfiguration('rviz').perform(context) == 'true':
        view = Path(get_package_share_directory('robots_controller'), 'config', 'cell.rviz')
        started.append(
            Node(package='rviz2', executable='rviz2', arguments=['-d', str(view)], namespace=namespace)
        )
    return started


def process(nodes: list[dict[str, Any]], namespace: str) -> Node:
    """The process of one node, or of several."""
    options: dict[str, Any] = {'namespace': namespace, 'output': 'screen'}
    if len(nodes) == 1:
        (node,) = nodes
        options |= {
            'package': node['package'],
            'name': node['executable'],
            'parameters': [node['parameters']],
        }
        return Node(executable=node['executable'], **options)
    # What has the same name has the same value in all nodes of a cell that can share a process.
    parameters = {name: value for node in nodes for name, value in node['parameters'].items()}
    options |= {'package': 'robots_controller', 'parameters': [parameters]}
    return Node(executable='composed_nodes', arguments=[node['executable'] for node in nodes], **options)


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` requests."""
    return LaunchDescription(
        [
            SetEnvironmentVariable(
                'ROS_AUTOMATIC_DISCOVERY_RANGE',
                EnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', default_value='LOCALHOST'),
            ),
            *(
                DeclareLaunchArgument(name, default_value=default, description=meaning)
                for name, (default, meaning) in (ARGUMENTS | LAUNCH_ARGUMENTS).items()
            ),
            OpaqueFunction(function=nodes),
        ]
    )

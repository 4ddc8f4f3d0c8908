"""ros2 launch robots_controller cell.launch.py program:=... robot:=... scene:=... io:=... io_map:=..."""

import json
import subprocess
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.conditions import IfCondition
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription

ARGUMENTS = {
    'robot': ('', "the robot's name"),
    'program': ('', 'Lua robot program to run'),
    'scene': ('', 'scene to keep clear of (YAML)'),
    'drive': ('second_order', 'ideal, second_order or rigid_body'),
    'guided': ('', 'inverse kinematics that follows reference_pose'),
    'watchdog': ('0.2', 'longest time without a sign of life, s'),
    'operating_mode': ('AUTOMATIC', 'AUTOMATIC, T1, T2 or REMOTE'),
    'tool_speed_limit': ('0.0', 'of tool and axes, m/s; 0 for none'),
    'debug_port': ('0', 'port for editors; 0 for none'),
    'io': ('', 'YAML script of a PLC that is played'),
    'io_map': ('', 'YAML map to topics of a PLC'),
}
"""Options of `cell`: their defaults, and what they mean."""


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes of the cell, from the same description that `cell` uses.

    `cell` describes them itself: `ros2` runs on the system's Python, which does not have what the package
    needs.
    """
    cell = Path(get_package_prefix('robots_controller'), 'lib', 'robots_controller', 'cell')
    command = [str(cell), '--describe']
    for name in ARGUMENTS:
        if value := LaunchConfiguration(name).perform(context):
            command += ['--' + name.replace('_', '-'), value]
    if LaunchConfiguration('composed').perform(context) == 'true':
        command.append('--composed')
    described = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    if described.returncode:
        raise RuntimeError(described.stderr.strip())
    namespace = LaunchConfiguration('namespace').perform(context)
    processes: dict[str, list[dict[str, Any]]] = {}
    for node in json.loads(described.stdout):
        processes.setdefault(node['process'], []).append(node)
    return [process(nodes, namespace) for nodes in processes.values()]


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
    """What `ros2 launch` asks for."""
    return LaunchDescription(
        [
            SetEnvironmentVariable(
                'ROS_AUTOMATIC_DISCOVERY_RANGE',
                EnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', default_value='LOCALHOST'),
            ),
            *(
                DeclareLaunchArgument(name, default_value=default, description=meaning)
                for name, (default, meaning) in ARGUMENTS.items()
            ),
            DeclareLaunchArgument('namespace', default_value='', description='namespace of all nodes'),
            DeclareLaunchArgument(
                'composed',
                default_value='false',
                description='true: all nodes but controller_node and drive_node share a process',
            ),
            DeclareLaunchArgument('rviz', default_value='false', description='true: show the robot in RViz'),
            OpaqueFunction(function=nodes),
            Node(
                package='rviz2',
                executable='rviz2',
                arguments=[
                    '-d',
                    str(Path(get_package_share_directory('robots_controller'), 'config', 'cell.rviz')),
                ],
                namespace=LaunchConfiguration('namespace'),
                condition=IfCondition(LaunchConfiguration('rviz')),
            ),
        ]
    )

"""ros2 launch robots_controller cell.launch.py program:=... robot:=... scene:=... io:=... io_map:=..."""

import json
import subprocess
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix
from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription

OPTIONS = (
    *('robot', 'program', 'io', 'io_map', 'scene', 'drive', 'guided', 'watchdog', 'debug_port'),
    *('operating_mode', 'tool_speed_limit', 'composed'),
)
FLAGS = ('composed',)


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes of the cell, from the same description that `cell` uses.

    `cell` describes them itself: `ros2` runs on the system's Python, which does not have what the package
    needs.
    """
    cell = Path(get_package_prefix('robots_controller'), 'lib', 'robots_controller', 'cell')
    command = [str(cell), '--describe']
    for name in OPTIONS:
        value = LaunchConfiguration(name).perform(context)
        if name in FLAGS:
            command += ['--' + name] if value == 'true' else []
        elif value:
            command += ['--' + name.replace('_', '-'), value]
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
            DeclareLaunchArgument('robot', default_value='', description="the robot's name"),
            DeclareLaunchArgument('program', default_value='', description='Lua robot program to run'),
            DeclareLaunchArgument('scene', default_value='', description='scene to keep clear of (YAML)'),
            DeclareLaunchArgument(
                'drive', default_value='second_order', description='ideal, second_order or rigid_body'
            ),
            DeclareLaunchArgument(
                'guided', default_value='', description='inverse kinematics that follows reference_pose'
            ),
            DeclareLaunchArgument('namespace', default_value='', description='namespace of all nodes'),
            DeclareLaunchArgument(
                'watchdog', default_value='0.2', description='longest time without a sign of life, s'
            ),
            DeclareLaunchArgument(
                'operating_mode', default_value='AUTOMATIC', description='AUTOMATIC, T1, T2 or REMOTE'
            ),
            DeclareLaunchArgument(
                'tool_speed_limit', default_value='0.0', description='of tool and axes, m/s; 0 for none'
            ),
            DeclareLaunchArgument(
                'debug_port', default_value='0', description='port for editors; 0 for none'
            ),
            DeclareLaunchArgument(
                'composed',
                default_value='false',
                description='true: all nodes but controller_node and drive_node share a process',
            ),
            DeclareLaunchArgument('io', default_value='', description='YAML script of a PLC that is played'),
            DeclareLaunchArgument('io_map', default_value='', description='YAML map to topics of a PLC'),
            OpaqueFunction(function=nodes),
        ]
    )

"""ros2 launch robots_controller cell.launch.py robot:=... program:=... namespace:=..."""

from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription
from robots_controller.cell_graph import cell_graph


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes of the cell, from the same description that `cell` uses."""
    value = {name: LaunchConfiguration(name).perform(context) for name in ('robot', 'program', 'namespace')}
    graph = cell_graph(robot=value['robot'], program=value['program'], autostart=bool(value['program']))
    return [
        Node(
            package=node.package,
            executable=node.executable,
            name=node.name,
            namespace=value['namespace'],
            parameters=[dict(node.parameters)],
            output='screen',
        )
        for node in graph
    ]


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch` asks for."""
    return LaunchDescription(
        [
            SetEnvironmentVariable(
                'ROS_AUTOMATIC_DISCOVERY_RANGE',
                EnvironmentVariable('ROS_AUTOMATIC_DISCOVERY_RANGE', default_value='LOCALHOST'),
            ),
            DeclareLaunchArgument('robot', default_value='bello_bot', description="the robot's name"),
            DeclareLaunchArgument('program', default_value='', description='Lua robot program to run'),
            DeclareLaunchArgument('namespace', default_value='', description='namespace of all nodes'),
            OpaqueFunction(function=nodes),
        ]
    )

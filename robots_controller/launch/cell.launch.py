"""ros2 launch robots_controller cell.launch.py program:=... robot:=... scene:=... io:=... io_map:=..."""

from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import EnvironmentVariable, LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchContext, LaunchDescription
from robots_controller.cell_graph import DEFAULT_ROBOT, cell_graph
from robots_controller.program_header import ProgramHeader, read_program_header


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes of the cell, from the same description that `cell` uses."""
    value = {
        name: LaunchConfiguration(name).perform(context)
        for name in (
            'robot',
            'program',
            'namespace',
            'io',
            'io_map',
            'scene',
            'drive',
            'guided',
            'debug_port',
        )
    }
    header = read_program_header(value['program']) if value['program'] else ProgramHeader()
    cell = header.replaced_by(robot=value['robot'], scene=value['scene'], io=value['io'])
    graph = cell_graph(
        robot=cell.robot or DEFAULT_ROBOT,
        program=value['program'],
        autostart=bool(value['program']),
        drive=value['drive'],
        io=cell.io,
        io_map=value['io_map'],
        scene=cell.scene,
        guided=value['guided'],
        debug_port=int(value['debug_port']),
    )
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
                'debug_port', default_value='0', description='port for editors; 0 for none'
            ),
            DeclareLaunchArgument('io', default_value='', description='YAML script of a PLC that is played'),
            DeclareLaunchArgument('io_map', default_value='', description='YAML map to topics of a PLC'),
            OpaqueFunction(function=nodes),
        ]
    )

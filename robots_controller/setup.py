"""ament_python build of robots_controller."""

from glob import glob

from setuptools import find_packages, setup

package_name = 'robots_controller'

# Protocols that an I/O map may ask for.
plant = {
    'modbus': ['pymodbus>=3.11'],
    'mqtt': ['paho-mqtt>=2.0'],
    'opcua': ['asyncua>=1.1'],
}

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={
        package_name: ['py.typed', 'nodes/nodes.yaml'],
        f'{package_name}.interpreter.lua_side': ['*.lua'],
        f'{package_name}.report.page': ['*.js', '*.css', '*.html'],
        f'{package_name}.pendant': ['texts/*.yaml'],
        f'{package_name}.pendant.page': ['*.js', '*.css', 'access/*.html'],
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml', 'LICENSE']),
        (f'share/{package_name}/launch', glob('launch/*.launch.py')),
        (f'share/{package_name}/config', glob('config/*.yaml') + glob('config/*.rviz')),
    ],
    install_requires=['setuptools'],
    extras_require={
        'test': ['pytest'],
        **plant,
        'plant': [one for protocol in plant.values() for one in protocol],
    },
    zip_safe=False,
    maintainer='The Robots developers',
    maintainer_email='maintainers@robots.example',
    description='Robot controller: Lua robot programs, interpolator, I/O, the cell and its reports.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'robots = robots_controller.commands.robots:main',
            'cell = robots_controller.commands.command_table:CELL.main',
            'composed_nodes = robots_controller.live_cell.processes.composed_nodes:main',
            'io_bridge_node = robots_controller.nodes.io_bridge_node:main',
            'force_control_node = robots_controller.nodes.force_control_node:main',
            'wheel_soil_node = robots_controller.nodes.wheel_soil_node:main',
            'guide_player_node = robots_controller.nodes.guide_player_node:main',
            'opcua_node = robots_controller.nodes.opcua_node:main',
            'pendant_node = robots_controller.nodes.pendant_node:main',
            'plc_node = robots_controller.nodes.plc_node:main',
            'check_bag = robots_controller.commands.command_table:CHECK_BAG.main',
            'check_program = robots_controller.commands.command_table:CHECK_PROGRAM.main',
            'lua_meta = robots_controller.commands.command_table:LUA_META.main',
            'study = robots_controller.commands.command_table:STUDY.main',
            'report = robots_controller.commands.command_table:REPORT.main',
            'simulate = robots_controller.commands.command_table:SIMULATE.main',
            'replay_bag = robots_controller.commands.command_table:REPLAY_BAG.main',
            'controller_node = robots_controller.nodes.controller_node:main',
            'lua_program_node = robots_controller.nodes.lua_program_node:main',
        ],
    },
)

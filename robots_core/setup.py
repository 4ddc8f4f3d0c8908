"""ament_python build of robots_core."""

from setuptools import find_packages, setup

package_name = 'robots_core'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={'': ['*.pyi'], package_name: ['py.typed', 'ros/running/*.xml', 'nodes/nodes.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml', 'LICENSE']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},
    zip_safe=False,
    maintainer='The Robots developers',
    maintainer_email='maintainers@robots.example',
    description='Base classes of robot plugins, the blocks of kinematics, dynamics and drives, their nodes.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'collision_node = robots_core.nodes.collision_node:main',
            'direct_kinematics_node = robots_core.nodes.direct_kinematics_node:main',
            'drive_node = robots_core.nodes.drive_node:main',
            'dynamics_node = robots_core.nodes.dynamics_node:main',
            'hardware_node = robots_core.nodes.hardware_node:main',
            'inverse_kinematics_node = robots_core.nodes.inverse_kinematics_node:main',
            'moveit_config = robots_core.moveit_config:main',
            'motion_cueing_node = robots_core.nodes.motion_cueing_node:main',
            'robot_state_node = robots_core.nodes.robot_state_node:main',
            'visualizer_node = robots_core.nodes.visualizer_node:main',
        ],
    },
)

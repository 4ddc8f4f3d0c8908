"""ament_python build of robots_planning."""

from setuptools import find_packages, setup

package_name = 'robots_planning'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={'': ['*.pyi'], package_name: ['py.typed', 'nodes/nodes.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml', 'LICENSE']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},
    zip_safe=False,
    maintainer='The Robots developers',
    maintainer_email='maintainers@robots.example',
    description='Path-planning blocks, trajectory verification and the planning node.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'planning_node = robots_planning.nodes.planning_node:main',
        ],
        'robots_planning.planners': [
            f'{name} = robots_planning.trajectory_generators.{module}'
            for name, module in (
                ('linear_joint', 'linear_joint:LinearJoint'),
                ('linear_joint_axes', 'linear_joint:LinearJointAxes'),
                ('collision_free', 'collision_free_joint:CollisionFreeJoint'),
                ('limited', 'linear_cartesian:LinearCartesianLimited'),
                ('dynamic_programming', 'linear_cartesian:LinearCartesianDynamicProgramming'),
                ('circular', 'curves_cartesian:CircularCartesian'),
                ('spline', 'curves_cartesian:SplineCartesian'),
            )
        ],
    },
)

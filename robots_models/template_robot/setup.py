"""ament_python build of template_robot; `pip install` works too."""

from pathlib import Path

from setuptools import setup

package_name = 'template_robot'
kinds = {'.urdf', '.yaml', '.stl', '.dae', '.obj'}
files = [
    str(file.relative_to(package_name)) for file in Path(package_name).rglob('*') if file.suffix in kinds
]

setup(
    name=package_name,
    version='0.1.0',
    packages=[package_name],
    package_data={package_name: files},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    description='A robot.',
    entry_points={'robots_core.robot_models': ['template_robot = template_robot.model:TemplateRobot']},
)

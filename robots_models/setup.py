"""ament_python build of robots_models."""

from pathlib import Path

from setuptools import find_packages, setup

package_name = 'robots_models'


def robot_files() -> list[str]:
    """Every URDF, limit file and mesh below a robot's folder, relative to the package."""
    root = Path(package_name)
    kinds = {'.urdf', '.yaml', '.stl'}
    return [str(file.relative_to(root)) for file in sorted(root.rglob('*')) if file.suffix in kinds]


def robots() -> list[str]:
    """The entry point of each robot: the class in its folder, `Ur5e` in `ur5e`."""
    names = sorted(file.parent.name for file in Path(package_name).glob('*/model.py'))
    return [
        f'{name} = {package_name}.{name}.model:{"".join(map(str.capitalize, name.split("_")))}'
        for name in names
    ]


setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={package_name: ['py.typed', *robot_files()]},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml', 'LICENSE']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},
    zip_safe=False,
    maintainer='The Robots developers',
    maintainer_email='maintainers@robots.example',
    description='Robots: one folder is one replaceable robot.',
    license='Apache-2.0',
    entry_points={'robots_core.robot_models': robots()},
)

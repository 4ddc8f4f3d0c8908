"""ament_python build of robots_models."""

from pathlib import Path

from setuptools import find_packages, setup

package_name = 'robots_models'


def robot_files() -> list[str]:
    """Every URDF, limit file and mesh below a robot's folder, relative to the package."""
    root = Path(package_name)
    kinds = {'.urdf', '.yaml', '.stl'}
    return [str(file.relative_to(root)) for file in sorted(root.rglob('*')) if file.suffix in kinds]


setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={package_name: ['py.typed', *robot_files()]},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='The Robots developers',
    maintainer_email='maintainers@robots.example',
    description='Robots: one folder is one replaceable robot.',
    license='Apache-2.0',
    entry_points={
        'robots_core.robot_models': [
            'bello_bot = robots_models.bello_bot.model:BelloBot',
            'kuka_kr210_r2700 = robots_models.kuka_kr210_r2700.model:KukaKr210R2700',
        ],
    },
)

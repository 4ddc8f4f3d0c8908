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
        (f'share/{package_name}', ['package.xml', 'LICENSE']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},
    zip_safe=False,
    maintainer='The Robots developers',
    maintainer_email='maintainers@robots.example',
    description='Robots: one folder is one replaceable robot.',
    license='Apache-2.0',
    entry_points={
        'robots_core.robot_models': [
            'bello_bot = robots_models.bello_bot.model:BelloBot',
            'cello_bot = robots_models.cello_bot.model:CelloBot',
            'debris_arm = robots_models.debris_arm.model:DebrisArm',
            'franka_fr3 = robots_models.franka_fr3.model:FrankaFr3',
            'kinova_j2n6s300 = robots_models.kinova_j2n6s300.model:KinovaJ2n6s300',
            'kuka_kr210_r2700 = robots_models.kuka_kr210_r2700.model:KukaKr210R2700',
            'kuka_kr210_r3100 = robots_models.kuka_kr210_r3100.model:KukaKr210R3100',
            'kuka_kr500_linear_axis = robots_models.kuka_kr500_linear_axis.model:KukaKr500LinearAxis',
            'kuka_kr500_r2830 = robots_models.kuka_kr500_r2830.model:KukaKr500R2830',
            'kuka_lbr_iiwa14 = robots_models.kuka_lbr_iiwa14.model:KukaLbrIiwa14',
            'manutec_r3 = robots_models.manutec_r3.model:ManutecR3',
            'mitsubishi_rv7frl = robots_models.mitsubishi_rv7frl.model:MitsubishiRv7frl',
            'rover_jaco = robots_models.rover_jaco.model:RoverJaco',
            'staubli_rx160 = robots_models.staubli_rx160.model:StaubliRx160',
            'staubli_tx2_90 = robots_models.staubli_tx2_90.model:StaubliTx290',
            'ur10e = robots_models.ur10e.model:Ur10e',
            'ur5e = robots_models.ur5e.model:Ur5e',
        ],
    },
)

"""KUKA LBR iiwa 14 R820, with seven axes."""

from dataclasses import dataclass
from math import pi

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class KukaLbrIiwa14Data(StructuralData):
    """Dimensions in metres, shoulder to wrist along the upright arm.

    `joint_stiffness` is in N m/rad, measured by a laboratory at TU Wien.
    """

    source: str = (
        'Frames and masses: github.com/lbr-stack/lbr_fri_ros2_stack @218d723 (Apache-2.0), '
        'lbr_description/urdf/iiwa14 (CAD export normalised to 29.9 kg). Limits of position and velocity: '
        'github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0). Efforts: KUKA brochure, as '
        "in Drake's iiwa_description. Accelerations: measured by a third party (Larsen, MSc thesis, Chalmers "
        "2019, table 4), not published by KUKA. Gear ratios, rotor inertias (gear's share included) and "
        'joint stiffness: parameter files of a laboratory at TU Wien, from KUKA machine data. Estimated: '
        'jerks (acceleration / 0.05 s). tool0 is the bare flange, 0.126 m beyond the wrist centre (0.152 m '
        'with the media flange). Lateral offsets of the frames along the axes cancel'
    )
    shoulder_height: float = 0.36
    upper_arm: float = 0.42
    forearm: float = 0.4
    flange: float = 0.126
    rated_payload_kg: float = 14.0
    reach: float = 0.82
    joint_stiffness: tuple[float, ...] = (60000.0, 60000.0, 40000.0, 40000.0, 40000.0, 20000.0, 20000.0)


class KukaLbrIiwa14(PackagedRobot):
    """KUKA's sensitive arm for 14 kg; at home the elbow is bent and the flange looks down."""

    DATA = KukaLbrIiwa14Data()
    HOME = (0.0, pi / 4, 0.0, -pi / 2, 0.0, pi / 4, 0.0)
    ORIENTATION_CONVENTION = 'zyx'

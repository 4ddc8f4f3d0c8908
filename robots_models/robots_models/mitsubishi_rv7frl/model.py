"""Mitsubishi RV-7FRL."""

from dataclasses import dataclass
from math import pi

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class MitsubishiRv7frlData(StructuralData):
    """Dimensions in metres; `elbow_offset` is how far axis 4 lies behind axis 3."""

    source: str = (
        'github.com/Mitsubishi-Electric-Asia/melfa_ros2_driver @8a52cd2 (Mitsubishi Electric, Apache-2.0): '
        'melfa_description/urdf/rv7frl and melfa_rv7frl_moveit_config (limits, home). Published: kinematics, '
        'limits of position and velocity. Unconfirmed data-sheet figures: reach, total mass of 67 kg. '
        'Estimated: accelerations (full speed within 0.2 s), jerks (acceleration / 0.05 s), masses and '
        'inertias (67 kg split like the bodies of a KUKA KR 210 R2700-2, solid cylinders of 2000 kg/m^3 '
        'between the axes), efforts (1.2 times the largest gravity torque plus the largest M_ii times '
        'acceleration, rated payload at (0.05, 0, 0.10) m from the flange, over 4000 random postures). Not '
        'published: gear ratios, rotor inertias'
    )
    shoulder_height: float = 0.4
    upper_arm: float = 0.435
    elbow_offset: float = 0.05
    forearm: float = 0.47
    flange: float = 0.085
    rated_payload_kg: float = 7.0
    reach: float = 0.908


class MitsubishiRv7frl(PackagedRobot):
    """Mitsubishi's MELFA arm for 7 kg and 0.9 m reach; orientations as rotations about fixed x, y, z."""

    DATA = MitsubishiRv7frlData()
    HOME = (0.0, 0.0, pi / 2, 0.0, pi / 2, 0.0)
    ORIENTATION_CONVENTION = 'XYZ'

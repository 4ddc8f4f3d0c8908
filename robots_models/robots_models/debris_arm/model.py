"""The debris arm: three axes on a chaser satellite, after the paper's section 5.3. Fictive."""

from dataclasses import dataclass

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class DebrisArmData(StructuralData):
    """Dimensions in metres, masses in kilograms."""

    source: str = (
        'Fictive: no figures of a three-axis arm for removing space debris are public, every figure was '
        'chosen for this project. Its base is a satellite: load it with gravity=(0, 0, 0), or by the name '
        '"debris_arm?gravity=0,0,0"; by default it stands on a test bench on earth'
    )
    shoulder_height: float = 1.15
    upper_arm: float = 1.7
    forearm: float = 1.6
    rated_payload_kg: float = 10.0


class DebrisArm(PackagedRobot):
    """Three axes and 3.3 m from shoulder to gripper; strong enough to be tested on earth."""

    DATA = DebrisArmData()
    HOME = (0.0, 0.6, 1.2)
    ORIENTATION_CONVENTION = 'xyz'

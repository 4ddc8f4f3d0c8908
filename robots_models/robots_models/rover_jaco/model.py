"""A rover with a mast that lifts a Kinova Jaco 2, after the paper's section 5.4. The rover is fictive."""

from dataclasses import dataclass

from robots_core import StructuralData
from robots_models.kinova_j2n6s300.model import KinovaJ2n6s300
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class RoverJacoData(StructuralData):
    """Dimensions in metres, masses in kilograms."""

    source: str = (
        'Rover and mast: fictive, every figure was chosen for this project, as no figures of the rover of '
        'the ROBEX mission are public that would do. The arm: see kinova_j2n6s300'
    )
    mast_height: float = 0.35
    mast_stroke: float = 0.4
    rated_payload_kg: float = 1.6


class RoverJaco(PackagedRobot):
    """A sliding axis, the mast, and the six axes of the arm; the rover itself stands on its wheels."""

    DATA = RoverJacoData()
    HOME = (0.2, *KinovaJ2n6s300.HOME)
    ORIENTATION_CONVENTION = KinovaJ2n6s300.ORIENTATION_CONVENTION

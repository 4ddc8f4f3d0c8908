"""Universal Robots' arms: six axes, three of them parallel."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True, kw_only=True)
class UniversalRobotsData(StructuralData):
    """Standard Denavit-Hartenberg lengths in metres, as Universal Robots names them.

    Attributes:
        d1: Base to shoulder.
        a2: Upper arm; negative, as the arm at zero points along -x.
        a3: Forearm; negative.
        d4: Lateral offset to wrist 1.
        d5: Wrist 1 to wrist 2.
        d6: Wrist 2 to the flange.
        rated_payload_kg: kg, an unconfirmed data-sheet figure.
        reach: An unconfirmed data-sheet figure.
    """

    d1: float
    a2: float
    a3: float
    d4: float
    d5: float
    d6: float
    rated_payload_kg: float
    reach: float


class UniversalRobots(PackagedRobot):
    """Base of the UR arms.

    Their base is the link `base` of the maker's ROS description, the frame Base of the controller: the arm at
    zero points along -x. The link `base_link`, which MoveIt and the maker's driver use (REP-103: x forward),
    is turned by pi about z, as there.
    """

    DATA: ClassVar[UniversalRobotsData]
    # The maker's upright start posture is singular: elbow bent to the front, tool looking down.
    HOME = (0.0, -pi / 2, pi / 2, -pi / 2, -pi / 2, 0.0)
    ORIENTATION_CONVENTION = 'rotation_vector'

"""Kinova Jaco 2 with six axes, a wrist that is not spherical, and a hand with three fingers (j2n6s300)."""

from dataclasses import dataclass
from math import pi

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class KinovaJ2n6s300Data(StructuralData):
    """Dimensions in metres, by the names of Kinova's table (DH Parameters of Jaco 1.0.8, 2013).

    Attributes:
        d1: Base to elbow, up to axis 2.
        d2: Upper arm.
        d3: Forearm, up to the wrist.
        d4: First wrist link.
        d5: Second wrist link.
        d6: Wrist to the centre of the hand.
        e2: Lateral offset of the arm.
        wrist_angle: rad between consecutive wrist axes.
    """

    source: str = (
        'github.com/Kinovarobotics/kinova-ros @924781d (Kinova, BSD): kinova_description/urdf and '
        'kinova_moveit; home: the factory home pose as in a public list of joint values. Published: '
        'kinematics, position limits, velocities (36 and 48 degrees per second), efforts, masses and centres '
        'of mass; inertias are those of solid cylinders and approximate. The fingers (six bodies of 0.01 kg) '
        'are left out. Unconfirmed data-sheet figures: payload, reach. Estimated: accelerations (full speed '
        'within 0.2 s), jerks (acceleration / 0.05 s). Not published: gear ratios, rotor inertias'
    )
    d1: float = 0.2755
    d2: float = 0.41
    d3: float = 0.2073
    d4: float = 0.0741
    d5: float = 0.0741
    d6: float = 0.16
    e2: float = 0.0098
    wrist_angle: float = pi / 3
    rated_payload_kg: float = 1.6
    reach: float = 0.9


class KinovaJ2n6s300(PackagedRobot):
    """Kinova's light arm for 1.6 kg; four of its axes turn without end. Upright with all joints at pi."""

    DATA = KinovaJ2n6s300Data()
    HOME = (-1.47550822, 2.92151711, 1.00484714, -2.08487422, 1.44703677, 1.31851771)
    # Kinova's controller gives its orientations as Euler angles about moving x, y, z.
    ORIENTATION_CONVENTION = 'xyz'

"""Staubli's six-axis arms with a spherical wrist."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True, kw_only=True)
class StaubliData(StructuralData):
    """Dimensions in metres, with facts that have no other place.

    Attributes:
        shoulder_height: Height of axis 2 above the base plane; Staubli's World frame sits there.
        shoulder_offset: Horizontal distance of axis 2 from axis 1.
        lateral_offset: How far the forearm stands beside axis 1, along axis 2.
        upper_arm: Distance of axes 2 and 3.
        forearm: Distance of axis 3 and the wrist centre.
        flange: Distance of the wrist centre and the flange.
        rated_payload_kg: kg, an unconfirmed data-sheet figure.
        maximum_payload_kg: kg, an unconfirmed data-sheet figure.
        manual_torque_limits: N m, the torque limits that the manual prints. They lie below the arm's own
            gravity torque, so they cannot be what the drives give; `AxesData.effort` is an estimate.
    """

    shoulder_height: float
    shoulder_offset: float
    lateral_offset: float
    upper_arm: float
    forearm: float
    flange: float
    rated_payload_kg: float
    maximum_payload_kg: float
    manual_torque_limits: tuple[float, ...]


class Staubli(PackagedRobot):
    """Base of the Staubli arms: upright with all joints at zero, orientations as Rx Ry Rz."""

    DATA: ClassVar[StaubliData]
    # No home is published but "all zero", which is singular: elbow bent, hand looking forward and down.
    HOME = (0.0, 0.0, pi / 2, 0.0, pi / 4, 0.0)
    ORIENTATION_CONVENTION = 'xyz'

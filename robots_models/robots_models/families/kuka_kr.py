"""KUKA's KR robots: six axes, in-line wrist."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True, kw_only=True)
class KukaKrData(StructuralData):
    """Dimensions in metres, with facts that have no other place.

    Attributes:
        axis_1_to_axis_2: Horizontal distance of axis 2 from axis 1.
        axis_2_height: Height of axis 2 above the mounting surface.
        upper_arm: Distance of axes 2 and 3.
        elbow_offset: How far axis 4 lies above axis 3 with the arm stretched forward.
        forearm: Distance of axis 3 and the wrist centre along axis 4.
        flange: Distance of the wrist centre and the flange.
        rated_payload_kg: Rated payload, kg. The published effort of A2 holds it not everywhere: KUKA
            publishes no counterbalance.
        payload_held_everywhere_kg: The payload, kg, that `AxesData.effort` holds in every posture.
        reach: Farthest wrist centre from axis 1 inside the limits.
        effort_estimate: N m, an estimate of what the drives give, the counterbalance included: 1.2 times
            (largest gravity torque + largest M_ii times listed acceleration) with the rated payload at
            (0.05, 0, 0.10) m from the flange, over random postures.
    """

    axis_1_to_axis_2: float
    axis_2_height: float
    upper_arm: float
    elbow_offset: float
    forearm: float
    flange: float
    rated_payload_kg: float
    payload_held_everywhere_kg: float
    reach: float
    effort_estimate: tuple[float, ...]


class KukaKr(PackagedRobot):
    """Base of the KR robots; home as in KUKA's own configuration (kuka_kr_moveit_config)."""

    DATA: ClassVar[KukaKrData]
    HOME = (0.0, -pi / 2, pi / 2, 0.0, 0.0, 0.0)
    ORIENTATION_CONVENTION = 'zyx'

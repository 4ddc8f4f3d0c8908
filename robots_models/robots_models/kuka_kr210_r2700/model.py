"""KUKA KR 210 R2700-2 (KR QUANTEC-2), the welding robot of the paper's section 4.4."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class KukaKr210R2700Data(StructuralData):
    """Dimensions in metres, as in KUKA's published robot description, with facts that have no other place.

    Attributes:
        axis_1_to_axis_2: Horizontal distance of axis 2 from axis 1.
        axis_2_height: Height of axis 2 above the mounting surface.
        upper_arm: Distance of axes 2 and 3.
        elbow_offset: Distance of axes 3 and 4.
        forearm: Distance of axis 3 and the wrist centre along axis 4.
        flange: Distance of the wrist centre and the flange.
        rated_payload_kg: Rated payload, kg. The published effort of A2 holds it not everywhere: KUKA
            publishes no counterbalance.
        payload_held_everywhere_kg: The payload, kg, that the published efforts hold in every posture.
        reach: Farthest wrist centre from axis 1 inside the limits.
        effort_estimate: N m, an estimate of what the drives give, the counterbalance included: 1.2 times
            (largest gravity torque + largest M_ii times listed acceleration) with the rated payload at
            (0.05, 0, 0.10) m from the flange, over random postures. `AxesData.effort` is as published.
    """

    source: str = (
        'github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0): '
        'kuka_quantec_support/urdf/kr210_r2700_2_macro.xacro and config/kr210_r2700_2_joint_limits.yaml; '
        'home: kuka_kr_moveit_config/srdf/kr_arm_macro.xacro. Published: kinematics, limits of position, '
        'velocity, acceleration and effort, masses and inertias (principal axes rotated into link frames). '
        'Estimated: jerk (acceleration / 0.1 s). Not published: gear ratios, rotor inertias, counterbalance'
    )
    axis_1_to_axis_2: float = 0.33
    axis_2_height: float = 0.645
    upper_arm: float = 1.15
    elbow_offset: float = 0.115
    forearm: float = 1.22
    flange: float = 0.215
    rated_payload_kg: float = 210.0
    payload_held_everywhere_kg: float = 177.0
    reach: float = 2.701
    effort_estimate: tuple[float, ...] = (6711.0, 14900.0, 5911.0, 967.5, 835.8, 124.7)


class KukaKr210R2700(PackagedRobot):
    """KUKA's QUANTEC robot for 210 kg and 2.7 m reach; home as in KUKA's own configuration."""

    DATA = KukaKr210R2700Data()
    HOME = (0.0, -pi / 2, pi / 2, 0.0, 0.0, 0.0)

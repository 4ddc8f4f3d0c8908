"""KUKA KR 210 R2700-2 (KR QUANTEC-2), the welding robot of the paper's section 4.4."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import as_file, files

import numpy as np

from robots_core import StructuralData, UrdfRobotModel


@dataclass(frozen=True)
class KukaKr210R2700Data(StructuralData):
    """Dimensions in metres, as in KUKA's published robot description."""

    source: str = (
        'github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0): kr210_r2700_2; '
        'jerk is an estimate (acceleration / 0.1 s), everything else is published'
    )
    axis_1_to_axis_2_x: float = 0.33
    axis_2_height: float = 0.645
    upper_arm: float = 1.15
    elbow_offset: float = 0.115
    forearm: float = 1.22
    flange: float = 0.215
    rated_payload_kg: float = 210.0


class KukaKr210R2700(UrdfRobotModel):
    """KUKA's QUANTEC robot for 210 kg and 2.7 m reach; home as in KUKA's own configuration."""

    def __init__(self) -> None:
        with as_file(files(__package__)) as folder:
            super().__init__(
                folder / 'robot.urdf',
                name='kuka_kr210_r2700',
                structural_data=KukaKr210R2700Data(),
                home=np.array([0.0, -np.pi / 2, np.pi / 2, 0.0, 0.0, 0.0]),
            )

"""Bello Bot, a fictive robot with seven axes arranged like a human arm."""

from dataclasses import dataclass
from math import pi

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class BelloBotData(StructuralData):
    """Dimensions in metres, masses in kilograms. Shoulder and wrist axes meet in one point each."""

    source: str = (
        'Fictive: no such robot exists, every figure was chosen for this project. Named after the fictive '
        'robot of the DLR Robots library'
    )
    shoulder_height: float = 0.42
    upper_arm: float = 0.55
    forearm: float = 0.55
    hand: float = 0.2
    rated_payload_kg: float = 5.0


class BelloBot(PackagedRobot):
    """Seven axes, 1.3 m from shoulder to flange, for 5 kg; at home the tool points down at a table."""

    DATA = BelloBotData()
    HOME = (0.0, 0.5, 0.0, 1.5, 0.0, pi - 2.0, 0.0)

"""Cello Bot, a fictive robot: a carriage that slides up a neck, with a bow arm of four axes."""

from dataclasses import dataclass

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class CelloBotData(StructuralData):
    """Dimensions in metres, masses in kilograms."""

    source: str = 'Fictive: no such robot exists, every figure was chosen for this project'
    neck_offset: float = 0.16
    lowest_carriage: float = 0.5
    stroke: float = 0.7
    shoulder_offset: float = 0.1
    upper_arm: float = 0.4
    elbow_rise: float = 0.08
    forearm: float = 0.35
    hand: float = 0.15
    rated_payload_kg: float = 2.0


class CelloBot(PackagedRobot):
    """One sliding and four turning axes; at home the bow hand stands before the strings."""

    DATA = CelloBotData()
    HOME = (0.2, -0.8, 1.4, 0.0, 0.0)

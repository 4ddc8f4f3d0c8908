"""A robot with three axes, to be replaced by yours."""

from dataclasses import dataclass

from robots_core import StructuralData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class TemplateRobotData(StructuralData):
    """Whatever you want to keep about the robot, in SI units."""

    source: str = 'Where the figures come from, and which of them are estimated'
    upper_arm: float = 0.4
    forearm: float = 0.4


class TemplateRobot(PackagedRobot):
    """One line that says what it is."""

    DATA = TemplateRobotData()
    HOME = (0.0, -0.5, 1.2)  # rad, one number per axis, inside the limits and free of collisions
    ORIENTATION_CONVENTION = 'zyx'  # its maker's, one of ORIENTATION_CONVENTIONS: zyx is KUKA's

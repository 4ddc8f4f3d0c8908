"""KUKA KR 500 R2830 on a linear axis, as the paper's motion simulator may have one. The axis is fictive."""

from dataclasses import dataclass

from robots_core import StructuralData
from robots_models.kuka_kr500_r2830.model import KukaKr500R2830
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class KukaKr500LinearAxisData(StructuralData):
    """Dimensions in metres, masses in kilograms."""

    source: str = (
        "Linear axis: fictive, chosen for this project, of the order of the makers' units for such robots "
        '(8 m of travel, 1.8 m/s, 1.5 m/s^2, 15 kN). The robot: see kuka_kr500_r2830'
    )
    travel: float = 8.0
    carriage_kg: float = 800.0
    rated_payload_kg: float = KukaKr500R2830.DATA.rated_payload_kg


class KukaKr500LinearAxis(PackagedRobot):
    """A sliding axis along x, E1, and the six axes of the robot on its carriage."""

    DATA = KukaKr500LinearAxisData()
    HOME = (0.0, *KukaKr500R2830.HOME)
    ORIENTATION_CONVENTION = KukaKr500R2830.ORIENTATION_CONVENTION

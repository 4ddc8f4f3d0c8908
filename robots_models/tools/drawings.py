"""The drawings of all robots of this package, in base coordinates."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from robot_shapes import (
    bello_bot,
    cello_bot,
    debris_arm,
    franka_fr3,
    kinova_j2n6s300,
    kuka_lbr_iiwa14,
    manutec_r3,
    mitsubishi_rv7frl,
)
from robot_shapes.kuka_kr import kuka_kr_parts
from robot_shapes.staubli import staubli_parts
from robot_shapes.universal_robots import universal_robots_parts
from robots_models.kuka_kr210_r2700.model import KukaKr210R2700
from robots_models.kuka_kr210_r3100.model import KukaKr210R3100
from robots_models.kuka_kr500_r2830.model import KukaKr500R2830
from robots_models.staubli_rx160.model import StaubliRx160
from robots_models.staubli_tx2_90.model import StaubliTx290
from robots_models.ur5e.model import Ur5e
from robots_models.ur10e.model import Ur10e
from solids import Drawing

DRAWINGS: Final[Mapping[str, Drawing]] = MappingProxyType(
    {
        'bello_bot': bello_bot.PARTS,
        'cello_bot': cello_bot.PARTS,
        'debris_arm': debris_arm.PARTS,
        'franka_fr3': franka_fr3.PARTS,
        'kinova_j2n6s300': kinova_j2n6s300.PARTS,
        'kuka_kr210_r2700': kuka_kr_parts(KukaKr210R2700.DATA),
        'kuka_kr210_r3100': kuka_kr_parts(KukaKr210R3100.DATA),
        'kuka_kr500_r2830': kuka_kr_parts(KukaKr500R2830.DATA, bulk=1.3),
        'kuka_lbr_iiwa14': kuka_lbr_iiwa14.PARTS,
        'manutec_r3': manutec_r3.PARTS,
        'mitsubishi_rv7frl': mitsubishi_rv7frl.PARTS,
        'staubli_rx160': staubli_parts(StaubliRx160.DATA, bulk=1.35),
        'staubli_tx2_90': staubli_parts(StaubliTx290.DATA, pale=True),
        'ur10e': universal_robots_parts(Ur10e.DATA, bulk=1.28),
        'ur5e': universal_robots_parts(Ur5e.DATA),
    }
)
"""The parts by robot, with all joints at `drawn_at`."""


def drawn_at(robot: str) -> float:
    """Angle of all joints in the drawing, rad (m)."""
    return math.pi if robot == 'kinova_j2n6s300' else 0.0

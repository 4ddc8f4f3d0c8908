"""What the UR10e looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.universal_robots_shapes import universal_robots_parts
from robots_models.ur10e.model import Ur10e

PARTS: Final = universal_robots_parts(Ur10e.DATA, bulk=1.28)
DRAWING_POSTURE: Final = (0.0,) * 6

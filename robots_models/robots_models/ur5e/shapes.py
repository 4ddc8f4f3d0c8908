"""What the UR5e looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.universal_robots_shapes import universal_robots_parts
from robots_models.ur5e.model import Ur5e

PARTS: Final = universal_robots_parts(Ur5e.DATA)
DRAWING_POSTURE: Final = (0.0,) * 6

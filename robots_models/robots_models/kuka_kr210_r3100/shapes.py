"""What the KUKA KR 210 R3100-2 looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.kuka_kr_shapes import kuka_kr_parts
from robots_models.kuka_kr210_r3100.model import KukaKr210R3100

PARTS: Final = kuka_kr_parts(KukaKr210R3100.DATA)
DRAWING_POSTURE: Final = (0.0,) * 6

"""What the KUKA KR 210 R2700-2 looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.kuka_kr_shapes import kuka_kr_parts
from robots_models.kuka_kr210_r2700.model import KukaKr210R2700

PARTS: Final = kuka_kr_parts(KukaKr210R2700.DATA)
DRAWING_POSTURE: Final = (0.0,) * 6

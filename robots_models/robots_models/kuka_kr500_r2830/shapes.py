"""What the KUKA KR 500 R2830 looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.kuka_kr_shapes import kuka_kr_parts
from robots_models.kuka_kr500_r2830.model import KukaKr500R2830

PARTS: Final = kuka_kr_parts(KukaKr500R2830.DATA, bulk=1.3)
DRAWING_POSTURE: Final = (0.0,) * 6

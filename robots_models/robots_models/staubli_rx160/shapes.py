"""What the Staubli RX160 looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.staubli_shapes import staubli_parts
from robots_models.staubli_rx160.model import StaubliRx160

PARTS: Final = staubli_parts(StaubliRx160.DATA, bulk=1.35)
DRAWING_POSTURE: Final = (0.0,) * 6

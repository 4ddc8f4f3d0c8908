"""What the Staubli TX2-90 looks like."""

from __future__ import annotations

from typing import Final

from robots_models.families.staubli_shapes import staubli_parts
from robots_models.staubli_tx2_90.model import StaubliTx290

PARTS: Final = staubli_parts(StaubliTx290.DATA, pale=True)
DRAWING_POSTURE: Final = (0.0,) * 6

"""A published single-wheel test, and soil parameters that were identified from it here.

L. Ding, H. Gao, Z. Deng, K. Nagatani and K. Yoshida, Experimental study and analysis on driving wheels'
performance for planetary exploration rovers moving in deformable soil, Journal of Terramechanics 48, 2011:
a smooth wheel at 80 N. The numbers are those of the public data set single-wheel-tests (PINNeAPPle-Labs, on
Hugging Face, there `ding2011`, soil TYII); they were not compared with the publication.
"""

from __future__ import annotations

from typing import Final

from robots_core.blocks import Soil, Wheel

WHEEL: Final = Wheel(radius=0.15735, width=0.165)
LOAD: Final = 80.0  # N
MEASURED: Final = (
    (0.0, -6.5, 0.0, 5.0),
    (0.1, 11.0, 3.0, 5.5),
    (0.2, 14.5, 4.2, 7.5),
    (0.3, 15.0, 4.8, 10.0),
    (0.4, 15.0, 5.0, 12.5),
    (0.6, 15.0, 5.3, 17.5),
)
"""Slip, drawbar pull (N), torque (N m) and sinkage (mm)."""
SOIL: Final = Soil(
    k_c=0.0, k_phi=5.0e6, n=1.0, cohesion=630.0, friction=0.36, shear_modulus=2.4e-3, c1=0.6, c2=0.39
)
"""By least squares, on sinkage with less weight; not those of the publication."""

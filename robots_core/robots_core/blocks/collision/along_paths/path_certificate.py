"""PathCertificate: proofs that pieces of paths are free, for searches that need thousands of them."""

from math import comb

import numpy as np

from robots_core.blocks.collision.along_paths.certificate_kernel import (
    FREE,
    blocking_pair,
    certify,
    certify_line,
)
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.validation import Array


class PathCertificate:
    """Certificates of a robot in a scene; `body` and `placed` are what compiled searches call `certify` with.

    It shares the scratch memory of the solids, which it places elsewhere.

    Args:
        solids: Its solids and those around it, with the pairs to keep apart.
    """

    def __init__(self, solids: SolidSet) -> None:
        self.body, self.placed = solids.body, solids.placed
        self.work = np.zeros(1, dtype=np.int64)
        """Number of postures that were checked."""

    def line(self, start: Array, end: Array, margins: Array) -> int:
        """The pair that blocks the straight line between two postures, (n,) each, or FREE.

        Args:
            start: (n,) rad (m).
            end: (n,) rad (m).
            margins: Distance that each pair keeps, (p,) m.
        """
        # Read-only arrays would be compiled for again.
        start, end = np.array(start), np.array(end)
        return int(certify_line(self.body, self.placed, start, end, margins, self.work)[0])

    def piece(self, coefficients: Array, margins: Array) -> int:
        """The pair that blocks a polynomial over [0, 1], or FREE.

        Args:
            coefficients: In powers of s, (m, n).
            margins: Distance that each pair keeps, (p,) m.
        """
        # The derivative lies in the hull of its control points (Bernstein form).
        degree = len(coefficients) - 2
        slopes = np.arange(1, degree + 2)[:, None] * coefficients[1:]
        control = [
            sum(comb(j, k) / comb(degree, k) * slopes[k] for k in range(j + 1)) for j in range(degree + 1)
        ]
        speed = np.abs(control).max(axis=0)
        return int(certify(self.body, self.placed, coefficients, speed, margins, self.work)[0])

    def posture(self, q: Array, margins: Array) -> int:
        """A pair that is closer than its margin at joint positions `q`, (n,), or FREE."""
        return int(blocking_pair(self.body, self.placed, np.array(q), margins))


__all__ = ['FREE', 'PathCertificate']

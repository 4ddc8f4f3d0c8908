"""BlockTridiagonal: linear equations in which each unknown is coupled with its neighbours alone."""

import numpy as np

from robots_core.validation import Array


class BlockTridiagonal:
    """lower[k - 1] x[k - 1] + diagonal[k] x[k] + upper[k] x[k + 1] = right[k], factorised once.

    Elimination from the first block to the last, without pivoting (Golub and Van Loan 2013, section 4.5.1).

    Args:
        lower: (m - 1, n, n).
        diagonal: (m, n, n).
        upper: (m - 1, n, n).
    """

    def __init__(self, lower: Array, diagonal: Array, upper: Array) -> None:
        self._lower, self._upper = lower, upper
        self._inverses = [np.linalg.inv(diagonal[0])]
        for before, here, behind in zip(lower, diagonal[1:], upper, strict=True):
            self._inverses.append(np.linalg.inv(here - before @ self._inverses[-1] @ behind))

    def solve(self, right: Array) -> Array:
        """The unknowns of one right-hand side, (m, n), or of several, (m, n, k), in its shape."""
        x = right.copy()
        for k, lower in enumerate(self._lower):
            x[k + 1] -= lower @ (self._inverses[k] @ x[k])
        x[-1] = self._inverses[-1] @ x[-1]
        for k in range(len(x) - 2, -1, -1):
            x[k] = self._inverses[k] @ (x[k] - self._upper[k] @ x[k + 1])
        return x

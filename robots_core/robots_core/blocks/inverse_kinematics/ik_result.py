"""IkResult and IkBatch: results of numerical inverse kinematics."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots_core.validation import Array, read_only


@dataclass(frozen=True, eq=False)
class IkResult:
    """Joint positions for a pose, with the remaining errors.

    Attributes:
        q: Joint positions, (n,), rad (m), inside the limits, read-only; the closest found if not converged.
        converged: Both errors are inside the tolerances.
        iterations: Steps taken, over all restarts.
        position_error: Distance to the pose, m.
        orientation_error: Angle to the pose, rad.
    """

    q: Array
    converged: bool
    iterations: int
    position_error: float
    orientation_error: float

    def __post_init__(self) -> None:
        object.__setattr__(self, 'q', read_only(self.q))


@dataclass(frozen=True, eq=False)
class IkBatch:
    """Joint positions for m poses; each array is read-only and means the same as in `IkResult`.

    Attributes:
        q: (m, n), rad (m).
        converged: (m,) bool.
        iterations: (m,).
        position_error: (m,), m.
        orientation_error: (m,), rad.
    """

    q: Array
    converged: NDArray[np.bool_]
    iterations: NDArray[np.int64]
    position_error: Array
    orientation_error: Array

    def __post_init__(self) -> None:
        for array in (self.q, self.converged, self.iterations, self.position_error, self.orientation_error):
            array.flags.writeable = False

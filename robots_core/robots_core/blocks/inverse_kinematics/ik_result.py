"""IkResult: what a numerical inverse kinematics block found."""

from dataclasses import dataclass

from robots_core.validation import Array, read_only


@dataclass(frozen=True, eq=False)
class IkResult:
    """Joint positions for a pose, and how well they reach it.

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

"""SplineCartesian: a smooth curve of the tool through poses."""

from collections.abc import Sequence
from typing import ClassVar

from robots_core.pose import Pose
from robots_planning.paths.pose_spline import PoseSpline
from robots_planning.trajectory_generators.poses_generator import PosesGenerator


class SplineCartesian(PosesGenerator):
    """The tool passes all poses of the target on a smooth curve without a stop; see `PoseSpline`.

    Options: see `CartesianGenerator`.
    """

    kinds: ClassVar[tuple[str, ...]] = ('spline',)

    def path(self, start: Pose, poses: Sequence[Pose]) -> PoseSpline:
        """The spline from `start` through `poses`.

        Raises:
            InvalidInputError: no pose, or two in succession that coincide.
        """
        return PoseSpline([start, *poses])

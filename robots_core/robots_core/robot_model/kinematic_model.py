"""KinematicModel: the chain of frames from the robot's base to its tool."""

from abc import ABC, abstractmethod

from robots_core.validation import Array


class KinematicModel(ABC):
    """The paper's KinematicModel: coordinate frames of every axis for given joint positions."""

    @abstractmethod
    def frame_axes(self, q: Array) -> tuple[Array, Array]:
        """Frames of all axes, seen from the base.

        The frame of axis i sits on the axis and moves with the body behind it.

        Args:
            q: Joint positions, (n,), rad (m).

        Returns:
            r: Origins, (n, 3), m.
            T: Orientations, (n, 3, 3), axis frame to base.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """

"""CollisionModel: the robot's body for collision checks, fixed to its axis frames."""

from dataclasses import dataclass

from robots_core.robot_model.allowed_pairs import AllowedPairs
from robots_core.robot_model.shapes import Shape


@dataclass(frozen=True)
class CollisionModel:
    """Shapes for collision checks. Holds no kinematics: place them with `KinematicModel.frame_axes`.

    Attributes:
        shapes: The robot's body.
        allowed_pairs: Pairs of its shapes that need no check, as stored with the robot; None where nothing
            is stored, they are then found when they are needed.
    """

    shapes: tuple[Shape, ...]
    allowed_pairs: AllowedPairs | None = None

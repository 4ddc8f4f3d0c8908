"""CollisionModel: the robot's body for collision checks, fixed to its axis frames."""

from __future__ import annotations

from dataclasses import dataclass

from robots_core.robot_model.shapes import Shape


@dataclass(frozen=True)
class CollisionModel:
    """Shapes for collision checks. Holds no kinematics: place them with `KinematicModel.frame_axes`."""

    shapes: tuple[Shape, ...]

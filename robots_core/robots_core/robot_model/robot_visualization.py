"""RobotVisualization: what the robot looks like, fixed to its axis frames."""

from __future__ import annotations

from dataclasses import dataclass

from robots_core.robot_model.shapes import Shape


@dataclass(frozen=True)
class RobotVisualization:
    """Shapes for the eye. Holds no kinematics: place each shape with `KinematicModel.frame_axes`."""

    shapes: tuple[Shape, ...]

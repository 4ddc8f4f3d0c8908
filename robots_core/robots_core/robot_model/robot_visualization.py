"""RobotVisualization: the visual shapes of a robot, fixed to its axis frames."""

from dataclasses import dataclass

from robots_core.robot_model.shapes import Shape


@dataclass(frozen=True)
class RobotVisualization:
    """Visual shapes. Holds no kinematics: place each shape with `KinematicModel.frame_axes`."""

    shapes: tuple[Shape, ...]

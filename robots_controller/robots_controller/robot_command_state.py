"""RobotCommandState under the controller's name; it lives where the path planning can see it."""

from robots_planning.robot_command_state import RobotCommandState

__all__ = ['RobotCommandState']

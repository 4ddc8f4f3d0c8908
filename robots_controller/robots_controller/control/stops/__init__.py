"""Faults and stops: what is watched, what stops the robot, and how it brakes."""

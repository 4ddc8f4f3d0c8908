"""Closed-form inverse kinematics of six-axis arms, built from the axes of the robot itself."""

"""Inverse kinematics, in closed form, numerical and constrained, and the serial chain that they work on."""

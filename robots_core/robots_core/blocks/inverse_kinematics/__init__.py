"""Inverse kinematics: in closed form, numerical, inside limits, and of positions that are held."""

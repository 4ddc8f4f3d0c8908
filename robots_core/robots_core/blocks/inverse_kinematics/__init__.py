"""Inverse kinematics blocks."""

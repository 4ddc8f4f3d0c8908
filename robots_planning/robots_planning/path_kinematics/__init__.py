"""Inverse kinematics along a whole path, through singularities too."""

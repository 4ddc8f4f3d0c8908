"""Inverse kinematics along paths: following, choice of configurations, passage through singularities."""

"""Trajectory generators: one class per kind of motion, from a validated command to a checked plan."""

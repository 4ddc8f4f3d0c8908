"""Trajectory generators: one file each, one base."""

"""Kinova Jaco 2 on the mast of a rover."""

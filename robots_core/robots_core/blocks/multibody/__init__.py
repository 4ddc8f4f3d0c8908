"""Dynamics of the whole arm with payload, on a fixed, moving or floating base."""

"""Franka Research 3."""

"""Collision detection: solids, engines, scenes, and whole trajectories."""

"""Collision detection: solids, engines, scenes, proven distances, and search along joint paths."""

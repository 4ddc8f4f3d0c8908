"""Collision detection: solids, engines, scenes, and the guard that stops a robot before it collides."""

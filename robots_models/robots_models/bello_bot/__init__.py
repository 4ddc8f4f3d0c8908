"""Bello Bot, the fictive robot."""

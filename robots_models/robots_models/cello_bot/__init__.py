"""Cello Bot, the fictive robot that slides."""

"""Robots: one folder is one robot."""

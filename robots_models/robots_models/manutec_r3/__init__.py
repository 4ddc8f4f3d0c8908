"""Manutec r3."""

"""Jogging by held buttons, and what it is about to meet."""

"""Motions of a robot program: commands, targets, settings, guidance, and outputs switched on their paths."""

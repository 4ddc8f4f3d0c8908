"""Zones that a robot keeps clear of, or shares with others, watched while it moves."""

"""Checks of robot programs before anything moves: by reading, and by walking in simulation."""

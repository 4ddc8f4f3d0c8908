"""The scene of a node: its parameter and file, and the obstacles that messages add."""

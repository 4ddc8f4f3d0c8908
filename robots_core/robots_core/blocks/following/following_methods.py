"""Methods of following a reference pose, and their default settings."""

from typing import Final

METHODS: Final = ('constrained', 'damped_least_squares', 'analytical')
RATE: Final = 250.0  # Hz, joint references per second
LARGEST_DEVIATION: Final = 0.1  # rad (m), above which the controller does not follow

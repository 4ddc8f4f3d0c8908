"""Ways to follow a reference pose, and what holds for all of them where nothing else is chosen."""

from typing import Final

METHODS: Final = ('constrained', 'damped_least_squares', 'analytical')
RATE: Final = 250.0  # Hz, joint references per second
LARGEST_DEVIATION: Final = 0.1  # rad (m), from which on the controller does not follow

"""Names of the ways to follow a reference pose, for who only chooses one."""

from typing import Final

METHODS: Final = ('constrained', 'damped_least_squares', 'analytical')

"""The levels of simulated drives, by name."""

from typing import Final

DRIVE_LEVELS: Final = ('ideal', 'second_order', 'rigid_body')

"""Defaults that commands share with the functions of Python."""

from typing import Final

LONGEST_TIME: Final = 3600.0
"""Of a simulation, s of simulated time."""
LONGEST_WALK: Final = 600.0
"""Of one walk of `check_program`, s of simulated time."""
MOST_COMBINATIONS: Final = 256
"""Combinations of inputs with which `check_program` walks a program."""
DIGITAL_SIZE: Final = 32
"""Digital inputs, and digital outputs, of a cell."""
ANALOG_SIZE: Final = 8
"""Analog inputs, and analog outputs."""

"""Guide: what a program lets guide its robot."""

from enum import StrEnum


class Guide(StrEnum):
    """Handed over by the program alone; independent of its command state, which arcs and guidance share."""

    NONE = 'NONE'
    SENSOR = 'SENSOR'
    PERSON = 'PERSON'

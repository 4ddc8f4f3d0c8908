"""Guide: what a program lets guide its robot."""

from __future__ import annotations

from enum import StrEnum

from robots_core.errors import InvalidInputError


class Guide(StrEnum):
    """Handed over by the program alone; independent of its command state, which arcs and guidance share."""

    NONE = 'NONE'
    SENSOR = 'SENSOR'
    PERSON = 'PERSON'

    @classmethod
    def _missing_(cls, value: object) -> Guide:
        raise InvalidInputError(f'unknown guide {value!r}; guides are {", ".join(cls)}')

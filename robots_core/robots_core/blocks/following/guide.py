"""Guide: what may guide the robot of a program."""

from __future__ import annotations

from robots_core.wording.named_choice import NamedChoice


class Guide(NamedChoice):
    """Handed over by the program alone; independent of its command state, which arcs and guidance share."""

    NONE = 'NONE'
    SENSOR = 'SENSOR'
    PERSON = 'PERSON'

"""Configuration: which of the up to eight postures of a six-axis arm for a pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Configuration:
    """Branches of the shoulder, the elbow and the wrist, as the status bits of robot languages.

    Attributes:
        shoulder: 'front' where the wrist point is on the forward side of axis 1, 'back' where the arm reaches
            over its own base. Forward is where axis 2 is set off to from axis 1, otherwise the base's x at
            q1 = 0.
        elbow: 'up' where axis 3 is above the line from axis 2 to the wrist of an arm that reaches forward.
            It goes with the sign of q3, so that an arm reaching back has its elbow below when 'up'. Above is
            the sense of axis 1 that points along the base's z.
        wrist: 'no_flip' or 'flip': axis 5 bent to its positive or its negative side from where axes 4 and 6
            are in line (arms with three parallel axes: where axis 6 is parallel to them).
    """

    shoulder: Literal['front', 'back']
    elbow: Literal['up', 'down']
    wrist: Literal['no_flip', 'flip']

"""Configuration: the branch of the inverse kinematics of a six-axis arm, one of up to eight."""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import product
from typing import Any, Final, Literal, get_args, get_type_hints

from robots_core.errors import InvalidInputError


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

    @classmethod
    def parse(cls, text: str) -> Configuration:
        """The configuration of three words with '/' between them, as 'front/up/no_flip'.

        Raises:
            InvalidInputError: other words, or another number of them; names what is valid.
        """
        choices = _WORDS
        words: list[Any] = text.strip().split('/')
        if len(words) != len(choices) or any(word not in c for word, c in zip(words, choices, strict=True)):
            valid = ', '.join(f'{i.name} {" or ".join(c)}' for i, c in zip(fields(cls), choices, strict=True))
            raise InvalidInputError(
                f"configuration {text!r} must be three words with '/' between them: {valid}"
            )
        return cls(*words)

    def __str__(self) -> str:
        """The words that `parse` takes."""
        return f'{self.shoulder}/{self.elbow}/{self.wrist}'


_WORDS: Final = [get_args(get_type_hints(Configuration)[item.name]) for item in fields(Configuration)]
CONFIGURATIONS: Final = tuple('/'.join(words) for words in product(*_WORDS))
"""The texts of all configurations."""

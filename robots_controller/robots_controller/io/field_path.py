"""FieldPath: one number inside a message, by path."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

from robots_core.errors import InvalidInputError

_NAME: Final = '[A-Za-z_][A-Za-z0-9_]*'
_PATH: Final = re.compile(rf'{_NAME}(\.{_NAME}|\[[0-9]{{1,6}}\])*')
_STEP: Final = re.compile(rf'({_NAME})|\[([0-9]+)\]')


@dataclass(frozen=True)
class FieldPath:
    """Where a value stands in a message: `data[2]`, `pose.position.x`.

    Attributes:
        text: As it was written.
        steps: Names of fields and indices (from 0, as in the message) from the outside in.
    """

    text: str
    steps: tuple[str | int, ...]

    @classmethod
    def parse(cls, text: str) -> FieldPath:
        """The path of a text.

        Raises:
            InvalidInputError: not a path.
        """
        if not _PATH.fullmatch(text):
            raise InvalidInputError(
                f'{text!r} is no path of a field; paths are like data, data[2] or pose.position.x'
            )
        return cls(text, tuple(name or int(index) for name, index in _STEP.findall(text)))

    def get(self, message: Any) -> Any:
        """The value in a message, whose type has the field.

        Raises:
            InvalidInputError: an array of the message is too short.
        """
        value = message
        for depth, step in enumerate(self.steps):
            if isinstance(step, str):
                value = getattr(value, step)
            elif step < len(value):
                value = value[step]
            else:
                raise InvalidInputError(
                    f'{self.up_to(depth)} has {len(value)} elements; {self.text} needs {step + 1}'
                )
        return value

    def set(self, message: Any, value: float) -> None:
        """Set the value in a message that has the place; see `make_room`."""
        *outer, last = self.steps
        holder = FieldPath(self.text, tuple(outer)).get(message)
        if isinstance(last, int):
            holder[last] = value
        else:
            setattr(holder, last, value)

    def up_to(self, depth: int) -> str:
        """The text of the first steps."""
        text = ''.join(f'[{step}]' if isinstance(step, int) else f'.{step}' for step in self.steps[:depth])
        return text.removeprefix('.')

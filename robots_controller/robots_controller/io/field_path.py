"""FieldPath: one number inside a message, by path."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

from robots_core.errors import InvalidInputError

_STEP: Final = re.compile(r'\.?([A-Za-z_][A-Za-z0-9_]*)|\[(\d{1,6})\]')


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
        steps: list[str | int] = []
        position = 0
        while match := _STEP.match(text, position):
            if not steps and match.group(0)[0] in '.[':
                break
            if steps and match[1] and match.group(0)[0] != '.':
                break
            steps.append(match[1] or int(match[2]))
            position = match.end()
        if not steps or position != len(text):
            raise InvalidInputError(
                f'{text!r} is no path of a field; paths are like data, data[2] or pose.position.x'
            )
        return cls(text, tuple(steps))

    def get(self, message: Any) -> Any:
        """The value in a message.

        Raises:
            InvalidInputError: the message has no such field or element.
        """
        value = message
        for depth, step in enumerate(self.steps):
            value = self._step(value, step, depth)
        return value

    def set(self, message: Any, value: float) -> None:
        """Set the value in a message.

        Raises:
            InvalidInputError: the message has no such field or element.
        """
        *outer, last = self.steps
        holder = message
        for depth, step in enumerate(outer):
            holder = self._step(holder, step, depth)
        self._step(holder, last, len(outer))
        if isinstance(last, int):
            holder[last] = value
        else:
            setattr(holder, last, value)

    def _step(self, value: Any, step: str | int, depth: int) -> Any:
        if isinstance(step, int):
            try:
                return value[step]
            except IndexError:
                raise InvalidInputError(
                    f'{self.up_to(depth)} has {len(value)} elements; {self.text} needs {step + 1}'
                ) from None
            except TypeError:
                raise InvalidInputError(f'{self.up_to(depth)} is no array; {self.text} needs one') from None
        try:
            return getattr(value, step)
        except AttributeError:
            where = self.up_to(depth) or 'the message'
            raise InvalidInputError(f'{where} has no field {step!r}, which {self.text} needs') from None

    def up_to(self, depth: int) -> str:
        """The text of the first steps."""
        text = ''.join(f'[{step}]' if isinstance(step, int) else f'.{step}' for step in self.steps[:depth])
        return text.removeprefix('.')

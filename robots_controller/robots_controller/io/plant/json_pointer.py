"""JsonPointer: one value inside a JSON document, as RFC 6901 names it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

from robots_core.errors import InvalidInputError

_INDEX: Final = re.compile(r'0|[1-9][0-9]*')
_POINTER: Final = re.compile(r'(/([^~/]|~[01])*)*')


@dataclass(frozen=True)
class JsonPointer:
    """Where a value stands in a document: '' is all of it, '/press/force' and '/axes/0' are parts.

    Attributes:
        text: As it was written.
        steps: Names of members and indices of elements, from the outside in.
    """

    text: str
    steps: tuple[str, ...]

    @classmethod
    def parse(cls, text: str) -> JsonPointer:
        """The pointer of a text.

        Raises:
            InvalidInputError: not a pointer.
        """
        if not _POINTER.fullmatch(text):
            raise InvalidInputError(
                f"{text!r} is no JSON pointer; pointers are like '', /force or /axes/0/force"
            )
        return cls(text, tuple(step.replace('~1', '/').replace('~0', '~') for step in text.split('/')[1:]))

    def get(self, document: Any) -> Any:
        """The value in a document.

        Raises:
            InvalidInputError: the document has no such member or element.
        """
        value = document
        for step in self.steps:
            if isinstance(value, dict) and step in value:
                value = value[step]
            elif isinstance(value, list) and _INDEX.fullmatch(step) and int(step) < len(value):
                value = value[int(step)]
            else:
                raise InvalidInputError(f'the message has no {step!r}, which {self.text} needs')
        return value

    def put(self, document: Any, value: Any) -> Any:
        """A document of members alone, with the value in it; the document itself where the pointer is ''."""
        if not self.steps:
            return value
        holder = document = document if isinstance(document, dict) else {}
        for step in self.steps[:-1]:
            holder = holder.setdefault(step, {})
        holder[self.steps[-1]] = value
        return document

    def excludes(self, other: JsonPointer) -> bool:
        """One of the two is a part of the other: a document of members cannot have both."""
        shorter = min(len(self.steps), len(other.steps))
        return self.steps[:shorter] == other.steps[:shorter]

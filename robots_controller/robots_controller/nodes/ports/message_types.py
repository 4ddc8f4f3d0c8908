"""The types of a message's fields."""

import re
from typing import Any, Final

from robots_controller.io.bridge.topic_field import FieldPath
from robots_controller.io.number_kinds import INTEGERS
from robots_core.errors import InvalidInputError
from robots_core.ros.message_class import message_class

_ARRAY: Final = re.compile(r'sequence<(?P<listed>[^,]+)(, \d+)?>|(?P<fixed>[^\[]+)\[\d+\]')
NUMBERS: Final = ('boolean', 'float', 'double', *INTEGERS)


def number_type(kind: Any, path: FieldPath) -> str:
    """Type of the number at a path, one of `NUMBERS`.

    Raises:
        InvalidInputError: the message has no such field, or it is no number.
    """
    current = ''
    for depth, step in enumerate(path.steps):
        where = path.up_to(depth) or 'the message'
        if isinstance(step, int):
            element = _element(current)
            if not element:
                raise InvalidInputError(f'{where} is {current!r} and no array, which {path.text} needs')
            current = element
        else:
            fields = {} if depth and '/' not in current else _fields(current, kind)
            if step not in fields:
                names = f'; its fields are {", ".join(fields)}' if fields else ''
                raise InvalidInputError(f'{where} has no field {step!r}, which {path.text} needs{names}')
            current = fields[step]
    if current not in NUMBERS:
        hint = f'; an element of it is {path.text}[0]' if _element(current) else ''
        raise InvalidInputError(f'{path.text} is {current!r}; needed is a number or a bool{hint}')
    return current


def make_room(message: Any, path: FieldPath) -> None:
    """Lengthen the arrays of a message until a path leads somewhere; its type was checked.

    Raises:
        InvalidInputError: an array of fixed length is too short.
    """
    holder, current = message, ''
    for depth, step in enumerate(path.steps):
        if isinstance(step, int):
            element = _element(current)
            while len(holder) <= step:
                if not current.startswith('sequence<'):
                    raise InvalidInputError(
                        f'{path.up_to(depth)} has {len(holder)} elements; {path.text} needs {step + 1}'
                    )
                zero = message_class(_full(element))() if '/' in element else _ZEROS.get(element, 0)
                holder.append(zero)
            holder, current = holder[step], element
        else:
            current = _fields(current, type(message))[step]
            holder = getattr(holder, step)


_ZEROS: Final[dict[str, Any]] = {'boolean': False, 'float': 0.0, 'double': 0.0, 'string': ''}


def _element(kind: str) -> str:
    match = _ARRAY.fullmatch(kind)
    return (match['listed'] or match['fixed']) if match else ''


def _full(kind: str) -> str:
    package, _, name = kind.rpartition('/')
    return f'{package.removesuffix("/msg")}/msg/{name}'


def _fields(kind: str, outermost: Any) -> dict[str, str]:
    found = message_class(_full(kind)) if kind else outermost
    fields: dict[str, str] = found.get_fields_and_field_types()
    return fields

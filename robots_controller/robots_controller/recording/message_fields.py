"""Fields of a message as flat paths and values, to be compared."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

Value = bool | int | float | str | bytes


def flat_fields(message: Any, path: str = '') -> Iterator[tuple[str, Value]]:
    """All values of a message of rosbags with their paths: `position[2]`, `header.stamp`.

    A time or duration is one value in ns; a list of key-value pairs is written with its keys:
    `values.line`; the length of a list is a value of its own, `position.length`.
    """
    if is_dataclass(message) and not isinstance(message, type):
        values = {
            field.name: getattr(message, field.name) for field in fields(message) if field.name[0] != '_'
        }
        if list(values) == ['sec', 'nanosec']:
            yield path, values['sec'] * 1_000_000_000 + values['nanosec']
            return
        for name, value in values.items():
            yield from flat_fields(value, f'{path}.{name}' if path else name)
    elif isinstance(message, (list, tuple, np.ndarray)):
        yield f'{path}.length', len(message)
        if len(message) and _is_pair(message[0]) and len({pair.key for pair in message}) == len(message):
            for pair in message:
                yield f'{path}.{pair.key}', pair.value
            return
        for index, item in enumerate(message.tolist() if isinstance(message, np.ndarray) else message):
            yield from flat_fields(item, f'{path}[{index}]')
    else:
        yield path, message


def _is_pair(item: Any) -> bool:
    return is_dataclass(item) and [field.name for field in fields(item) if field.name[0] != '_'] == [
        'key',
        'value',
    ]

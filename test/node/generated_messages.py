"""Messages of any type, generated from its definition: valid ones, nearly valid ones and nonsense."""

from __future__ import annotations

import copy
import random
import re
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

from hypothesis import strategies as st

from robots_core.ros.messages import message_class

LONGEST: Final = 3  # of generated sequences
_ARRAY: Final = re.compile(r'(?P<item>.+)\[(?P<size>\d+)\]$')
_SEQUENCE: Final = re.compile(r'sequence<(?P<item>[^,]+)(, *(?P<bound>\d+))?>$')
_FLOATS: Final = {'float': 3.4e38, 'double': 1.7e308}
_INTEGER: Final = re.compile(r'(?P<sign>u?)int(?P<bits>\d+)$')
_ODD_FLOATS: Final = (float('nan'), float('inf'), -float('inf'), 0.0, -0.0, 1.0, -1.0, 5e-324, 1e-9, 1e6, 1e9)
_ODD_TEXTS: Final = (
    *(
        '',
        ' ',
        '/',
        '%s',
        'ä\u202e😀',
        'base',
        'tool0',
        'world',
        'id',
        'ended',
        'progress',
        'payload',
        'SENSOR',
    ),
    *('soon', 'nan', '1e999', '-1', '0.0', '1.000000000', '[]', '{}', '[1e999, 0, 0, 0]'),
    *('file:///dev/null', 'package://none/none.stl', 'package://[none'),
)


@cache
def values(field_type: str, texts: tuple[str, ...] = ()) -> st.SearchStrategy[Any]:
    """Values of a field's type, as `get_fields_and_field_types` names it; of texts these above all."""
    if match := _ARRAY.match(field_type):
        size = int(match['size'])
        return st.lists(values(match['item'], texts), min_size=size, max_size=size)
    if match := _SEQUENCE.match(field_type):
        longest = min(LONGEST, int(match['bound'] or LONGEST))
        return st.lists(values(match['item'], texts), max_size=longest)
    if '/' in field_type:
        return messages_of(message_class(field_type.replace('/', '/msg/')), texts)
    return _text(texts) if field_type.startswith('string') else _plain(field_type)


def _text(texts: tuple[str, ...]) -> st.SearchStrategy[str]:
    odd = st.sampled_from((*texts, *_ODD_TEXTS)) | st.integers(1000, 5000).map(lambda count: count * '[')
    return odd | st.text(st.characters(exclude_characters='\0', exclude_categories=('Cs',)), max_size=20)


def _plain(field_type: str) -> st.SearchStrategy[Any]:
    if limit := _FLOATS.get(field_type):
        odd = st.sampled_from((*_ODD_FLOATS, limit, -limit, 1e-3 * limit))
        return odd | st.floats(-10.0, 10.0) | st.floats(width=32 if field_type == 'float' else 64)
    if match := _INTEGER.match(field_type):
        low, high = 0, 2 ** int(match['bits']) - 1
        if not match['sign']:
            low, high = -(high // 2) - 1, high // 2
        return st.sampled_from((low, high, 0, 1)) | st.integers(0, 12) | st.integers(low, high)
    return st.booleans() if field_type == 'boolean' else st.binary(min_size=1, max_size=1)


def messages_of(kind: type, texts: tuple[str, ...] = ()) -> st.SearchStrategy[Any]:
    """Messages of a class, every field anything."""
    fields = kind.get_fields_and_field_types()
    return st.builds(kind, **{name: values(field, texts) for name, field in fields.items()})


@st.composite
def nearly(draw: st.DrawFn, examples: list[Any], texts: tuple[str, ...] = ()) -> Any:
    """One of these messages, with up to two fields of any depth replaced."""
    message = copy.deepcopy(draw(st.sampled_from(examples)))
    for _ in range(draw(st.integers(0, 2))):
        _break(draw, message, texts)
    return message


def _break(draw: st.DrawFn, message: Any, texts: tuple[str, ...]) -> None:
    """Replace a field of the message, or of a message in it."""
    fields = message.get_fields_and_field_types()
    if not fields:
        return
    name = draw(st.sampled_from(sorted(fields)))
    field_type, value = fields[name], getattr(message, name)
    items = list(value) if _SEQUENCE.match(field_type) or _ARRAY.match(field_type) else []
    if hasattr(value, 'get_fields_and_field_types'):
        _break(draw, value, texts)
    elif items and draw(st.booleans()):
        index = draw(st.integers(0, len(items) - 1))
        if hasattr(items[index], 'get_fields_and_field_types'):
            _break(draw, items[index], texts)
        elif draw(st.booleans()) or _ARRAY.match(field_type):
            items[index] = draw(values(_item_type(field_type), texts))
        else:
            del items[index]
        setattr(message, name, items)
    else:
        setattr(message, name, draw(values(field_type, texts)))


def mixed(messages: Sequence[Any], rng: random.Random) -> Any:
    """A message of the type of these, each field of it and each item of a sequence from any of them."""
    fields = {}
    for name, field_type in messages[0].get_fields_and_field_types().items():
        found = [getattr(message, name) for message in messages]
        if _SEQUENCE.match(field_type) or _ARRAY.match(field_type):
            items = [item for value in found for item in value]
            fields[name] = [_of_any(items, rng) for _ in rng.choice(found)]
        else:
            fields[name] = _of_any(found, rng)
    return type(messages[0])(**fields)


def _of_any(found: Sequence[Any], rng: random.Random) -> Any:
    return mixed(found, rng) if hasattr(found[0], 'get_fields_and_field_types') else rng.choice(found)


def _item_type(field_type: str) -> str:
    match = _SEQUENCE.match(field_type) or _ARRAY.match(field_type)
    assert match is not None
    return match['item']

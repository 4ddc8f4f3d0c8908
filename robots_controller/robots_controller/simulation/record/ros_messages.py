"""Messages of the cell's topics without ROS, as rosbags has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, Final

import numpy as np
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from robots_core.message_builder import NANOSECONDS, MessageBuilder

STRING_ARRAY: Final = 9  # type of rcl_interfaces/ParameterValue
INFO: Final = 20  # level of rcl_interfaces/Log


@lru_cache(maxsize=1)
def typestore() -> Typestore:
    """The message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)


def message(type_name: str, *fields: Any, **named: Any) -> Any:
    """A message of its fields, in their order or by name."""
    return typestore().types[type_name](*fields, **named)


BUILD: Final = MessageBuilder(message)


def serialized(built: Any) -> memoryview:
    """A message in CDR."""
    return typestore().serialize_cdr(built, built.__msgtype__)


def id_of(nanoseconds: int) -> str:
    """Id of the command with this stamp, as nodes write it."""
    return f'{nanoseconds // NANOSECONDS}.{nanoseconds % NANOSECONDS:09d}'


def string_parameters(nanoseconds: int, node: str, values: Mapping[str, Sequence[str]]) -> Any:
    """rcl_interfaces/ParameterEvent of new parameters that are lists of strings."""
    none = np.zeros(0, np.uint8), np.zeros(0, np.bool_), np.zeros(0, np.int64), np.zeros(0)
    parameters = [
        message(
            'rcl_interfaces/msg/Parameter',
            name,
            message(
                'rcl_interfaces/msg/ParameterValue', STRING_ARRAY, False, 0, 0.0, '', *none, list(strings)
            ),
        )
        for name, strings in values.items()
    ]
    return message('rcl_interfaces/msg/ParameterEvent', BUILD.time(nanoseconds), node, parameters, [], [])


def log(nanoseconds: int, name: str, words: str) -> Any:
    """rcl_interfaces/Log."""
    return message('rcl_interfaces/msg/Log', BUILD.time(nanoseconds), INFO, name, words, '', '', 0)

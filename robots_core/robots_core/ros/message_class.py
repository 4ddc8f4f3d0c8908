"""Classes of messages and actions, by their names."""

from functools import cache
from importlib import import_module
from typing import Any

from robots_core.errors import InvalidInputError


@cache
def message_class(type_name: str) -> Any:
    """The class of a message type.

    Args:
        type_name: As package/msg/Name.

    Raises:
        InvalidInputError: the package is not installed, or has no such message.
    """
    package, _, name = type_name.split('/')
    try:
        module = import_module(f'{package}.msg')
    except ImportError as error:
        raise InvalidInputError(f'{type_name}: the package {package!r} cannot be imported: {error}') from None
    found = getattr(module, name, None)
    if found is None:
        raise InvalidInputError(f'{type_name}: {package!r} has no message {name!r}')
    return found


def action_type(name: str) -> Any:
    """An action of control_msgs; None where that is not installed, or has no such action."""
    try:
        return getattr(import_module('control_msgs.action'), name, None)
    except ImportError:
        return None

"""Fail-safe values of outputs, which they take when no program controls them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, TypeVar

from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import channel_at, parse_channel, value_at
from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection

Value = TypeVar('Value', bound=float | None)

FailSafe = Mapping[str, float | None]
"""Values by the names of outputs; None keeps what the output has. Outputs that are not named get 0."""

HOLD: Final = 'hold'
"""In files: the output keeps its value, as one that closes a gripper."""


def read_fail_safe(section: YamlSection, signals: Mapping[str, Channel]) -> dict[str, float | None]:
    """The section `fail_safe` of a file: `{gripper: hold, analog_output.1: 2.5}`.

    Raises:
        InvalidInputError: no output, or a value that it cannot have; with its line.
    """
    found: dict[str, float | None] = {}
    for below, key in section.entries('fail_safe'):
        channel = channel_at(below, key, below.line_of(key), signals)
        if channel.direction == 'input':
            raise below.error(f'{key} is an input; outputs have fail-safe values here', key)
        if channel.name in found:
            raise below.error(f'{channel.name} has a fail-safe value already', key)
        found[channel.name] = fail_safe_of(below, key, channel)
    return found


def fail_safe_of(section: YamlSection, key: str, output: Channel) -> float | None:
    """The fail-safe value of one output: 'hold', or a value that it can have.

    Raises:
        InvalidInputError: another value; with its line.
    """
    if section.text(key) == HOLD:
        return None
    return value_at(section, key, output)


def fail_safe_texts(values: FailSafe) -> list[str]:
    """As parameters of nodes: 'digital_output.3=hold', 'analog_output.1=2.5'."""
    return [f'{name}={HOLD if value is None else repr(value)}' for name, value in values.items()]


def parse_fail_safe(texts: Iterable[str]) -> dict[str, float | None]:
    """The values in texts of `fail_safe_texts`; empty texts are ignored.

    Raises:
        InvalidInputError: not of the form output=value, no output, or a value that it cannot have.
    """
    found: dict[str, float | None] = {}
    for text in filter(None, texts):
        name, _, value = text.partition('=')
        channel = parse_channel(name, {})
        if channel.direction == 'input':
            raise InvalidInputError(f'{name} is an input; outputs have fail-safe values')
        try:
            number = None if value == HOLD else float(value)
        except ValueError:
            raise InvalidInputError(
                f'{text!r} is no fail-safe value; valid are digital_output.3={HOLD}, analog_output.1=2.5'
            ) from None
        found[name] = None if number is None else channel.checked(number)
    return found


def safe_value(values: FailSafe, output: Channel, value: Value) -> float | Value:
    """What an output that has a value now, None where that is unknown, is set to."""
    safe = values.get(output.name, 0.0)
    return value if safe is None else safe

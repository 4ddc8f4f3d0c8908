"""ChannelDeclarations: the sections on channels that a scripted PLC and an I/O map have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from robots_controller.io.fail_safe import FailSafe, read_fail_safe
from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import read_signals
from robots_controller.io.stopping_inputs import read_emergency_stop
from robots_core.files.yaml_section import YamlSection


@dataclass(frozen=True, kw_only=True)
class ChannelDeclarations:
    """The sections that every file of a cell's inputs and outputs may have.

    Attributes:
        signals: Channels by their names.
        fail_safe: Values of outputs when no program controls them.
        emergency_stop: Values of digital inputs that stop the robot, by channel.
    """

    signals: Mapping[str, Channel] = field(default_factory=lambda: MappingProxyType({}))
    fail_safe: FailSafe = field(default_factory=lambda: MappingProxyType({}))
    emergency_stop: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}))


def read_declarations(section: YamlSection) -> ChannelDeclarations:
    """The declarations of a file.

    Raises:
        InvalidInputError: what is wrong, with its line.
    """
    signals = read_signals(section)
    return ChannelDeclarations(
        signals=MappingProxyType(signals),
        fail_safe=MappingProxyType(read_fail_safe(section, signals)),
        emergency_stop=MappingProxyType(read_emergency_stop(section, signals)),
    )

"""CellIo: with whom the inputs and outputs of a cell are connected, and what its channels are called."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from robots_controller.io.fail_safe import FailSafe
from robots_controller.io.io_image import Channel
from robots_controller.io.io_map import IoMap, read_io_map
from robots_controller.io.io_signals import channel_labels
from robots_controller.io.plc_script import PlcScript, read_plc_script
from robots_core.errors import RobotsError


@dataclass(frozen=True)
class CellIo:
    """The PLC of a cell, scripted or at the other end of a map, or both.

    Attributes:
        script: Of the PLC that is played; without rules if there is none.
        io_map: Of channels to topics; empty if there is none.
        signals: Channels by their names.
        fail_safe: Values of outputs when no running program answers for them.
        emergency_stop: Values of digital inputs that stop the robot, by channel.
    """

    script: PlcScript
    io_map: IoMap
    signals: Mapping[str, Channel]
    fail_safe: FailSafe
    emergency_stop: Mapping[str, int]

    @property
    def labels(self) -> dict[str, list[str]]:
        """Names of channels, by image."""
        return channel_labels(list(self.signals.values()))

    @property
    def offline(self) -> PlcScript:
        """The script where nobody publishes the map's topics: its inputs keep their fail-safe values."""
        silent = {row.channel: row.fail_safe for row in self.io_map.inputs}
        return replace(self.script, initial=MappingProxyType({**self.script.initial, **silent}))


def read_cell_io(io: Path | str = '', io_map: Path | str = '') -> CellIo:
    """Read the files of a cell's inputs and outputs.

    Args:
        io: Script of a PLC that is played (see `plc_script`); '' for none.
        io_map: Map of channels to topics of a PLC (see `io_map`); '' for none.

    Raises:
        RobotsError: a file that is not valid; or both set inputs of the same kind, give one name to two
            channels, or one output two fail-safe values.
    """
    script = read_plc_script(io) if io else PlcScript(())
    rows = read_io_map(io_map) if io_map else IoMap()
    both = {channel.image for channel in script.inputs} & {row.channel.image for row in rows.inputs}
    if both:
        raise RobotsError(
            f'{io} and {io_map} both set {", ".join(sorted(both))}; only one can publish that topic'
        )
    for label in script.signals.keys() & rows.signals.keys():
        here, there = script.signals[label], rows.signals[label]
        if here != there:
            raise RobotsError(f'{label!r} is {here.name} in {io} and {there.name} in {io_map}')
    signals = {**script.signals, **rows.signals}
    for name in script.fail_safe.keys() & rows.fail_safe.keys():
        if script.fail_safe[name] != rows.fail_safe[name]:
            raise RobotsError(f'{name} has one fail-safe value in {io} and another in {io_map}')
    safe = {**script.fail_safe, **rows.fail_safe}
    stopping = {**script.emergency_stop, **rows.emergency_stop}
    if {**rows.emergency_stop, **script.emergency_stop} != stopping:
        raise RobotsError(f'{io} and {io_map} name one input as emergency stop with different values')
    return CellIo(
        script,
        rows,
        MappingProxyType(signals),
        MappingProxyType(safe),
        MappingProxyType(stopping),
    )

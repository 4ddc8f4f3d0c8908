"""CellIo: with whom the inputs and outputs of a cell are connected, and what its channels are called."""

from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from robots_controller.defaults import DIGITAL_SIZE
from robots_controller.io.channel_declarations import ChannelDeclarations
from robots_controller.io.fail_safe import HOLD
from robots_controller.io.io_image import Channel
from robots_controller.io.io_map import IoMap, read_io_map
from robots_controller.io.io_signals import channel_labels, parse_channel
from robots_controller.io.plc_script import PlcScript, read_plc_script
from robots_core.errors import OptionError


@dataclass(frozen=True)
class CellIo(ChannelDeclarations):
    """The PLC of a cell, scripted or at the other end of a map, or both; and what both declare.

    Attributes:
        script: Of the PLC that is played; without rules if there is none.
        io_map: Of channels to topics; empty if there is none.
    """

    script: PlcScript
    io_map: IoMap

    @property
    def labels(self) -> dict[str, list[str]]:
        """Names of channels, by image."""
        return channel_labels(list(self.signals.values()))

    @property
    def inputs(self) -> tuple[Channel, ...]:
        """The inputs that the script or the map sets."""
        return (*self.script.inputs, *(row.channel for row in self.io_map.inputs))

    @property
    def offline(self) -> PlcScript:
        """The script for a map whose topics have no publisher: its inputs keep their fail-safe values."""
        silent = {row.channel: row.fail_safe for row in self.io_map.inputs}
        return replace(self.script, initial=MappingProxyType({**self.script.initial, **silent}))

    @property
    def unknown_offline(self) -> dict[int, str]:
        """Why the digital inputs of a map whose topics have no publisher are not known, by their indices."""
        return {
            row.channel.index: f'nothing sends {row.place.source} in a simulation'
            for row in self.io_map.inputs
            if row.channel.kind == 'digital'
        }


def read_cell_io(io: Path | str = '', io_map: Path | str = '', *, orbit: Path | str = '') -> CellIo:
    """Read the files of a cell's inputs and outputs.

    Args:
        io: Script of a PLC that is played (see `plc_script`); '' for none.
        io_map: Map of channels to topics of a PLC (see `io_map`); '' for none.
        orbit: Orbit in which the robot works (see `read_orbit`), whose gripper sets inputs; '' for none.

    Raises:
        RobotsError: a file that is not valid; two that set inputs, give one name to two channels, or one
            output two fail-safe values; an emergency stop by an input that neither sets.
    """
    script = read_plc_script(io) if io else PlcScript(())
    rows = read_io_map(io_map) if io_map else IoMap()
    both = {channel.image for channel in script.inputs} & {row.channel.image for row in rows.inputs}
    if both:
        raise OptionError(
            f'{io} and {io_map} both set {", ".join(sorted(both))}; only one can publish that topic'
        )
    setting = io if script.inputs else io_map if rows.inputs else ''
    if orbit and setting:
        raise OptionError(f'{orbit} and {setting} both set inputs; in orbit the gripper alone does')
    declared = {}
    for section in vars(ChannelDeclarations()):
        one, other = getattr(script, section), getattr(rows, section)
        for name in one.keys() & other.keys():
            if one[name] != other[name]:
                here, there = _shown(one[name]), _shown(other[name])
                raise OptionError(f'{section}: {name} is {here} in {io} and {there} in {io_map}')
        declared[section] = MappingProxyType({**one, **other})
    cell_io = CellIo(script, rows, **declared)
    _check_emergency_stop(cell_io, ' and '.join(str(file) for file in (io, io_map) if file))
    return cell_io


def _check_emergency_stop(cell_io: CellIo, files: str) -> None:
    """Refuse inputs that would never stop the robot: those that nothing sets, and those that a cell lacks."""
    known = {channel.name for channel in cell_io.inputs}
    for name in cell_io.emergency_stop:
        channel = parse_channel(name, {})
        if channel.index > DIGITAL_SIZE:
            raise OptionError(
                f'emergency_stop: {name} is no input of a cell, which has digital_input.1 to {DIGITAL_SIZE}'
            )
        if name not in known:
            valid = [one.name for one in cell_io.inputs if one.image == channel.image]
            raise OptionError(
                f'emergency_stop: {name} is set by nothing in {files}, so that it would never stop the '
                f'robot; a row of the I/O map, or initial or a rule of the PLC script, must set it; '
                f'valid are {", ".join(valid) or "none of the digital inputs"}'
            )


def _shown(value: Channel | float | None) -> str:
    if value is None:
        return HOLD
    return value.name if isinstance(value, Channel) else f'{value:g}'

"""SimulatedPlc: the scripted PLC beside a simulated program."""

from __future__ import annotations

from robots_controller.io.io_image import Channel, IoImage
from robots_controller.io.plc_script import PlcScript
from robots_controller.io.scripted_plc import ScriptedPlc
from robots_controller.program.motion_command import OutputChange


class SimulatedPlc:
    """Hears the outputs and sets the inputs once in each period, as a PLC does in its cycle.

    Args:
        script: Its rules.
        io: The program's inputs and outputs.
        start: The time at which it starts, s.
    """

    def __init__(self, script: PlcScript, io: IoImage, start: float) -> None:
        self._script, self._io = script, io
        self._plc = ScriptedPlc(script, start)
        self._outputs = {channel for channel in script.channels if channel.direction == 'output'}
        self._heard: list[tuple[Channel, float]] = []

    @property
    def images(self) -> dict[str, int]:
        """Images of the inputs that it sets, and how many inputs it tells of each."""
        images = sorted({channel.image for channel in self._script.inputs})
        return {
            image: max(channel.index for channel in self._script.inputs if channel.image == image)
            for image in images
        }

    @property
    def next_time(self) -> float:
        """When it does something by itself, s; now if it has not heard an output yet."""
        return 0.0 if self._heard else self._plc.next_time

    def begin(self) -> None:
        """Set the inputs that do not start at 0."""
        for channel, value in self._plc.inputs.items():
            self._io.set_value(self._own(channel), value)

    def hear(self, change: OutputChange) -> None:
        """An output has changed; the PLC sees it in its next cycle."""
        channel = Channel(change.kind, 'output', change.index)
        self._heard += [(one, change.value) for one in self._outputs if one.name == channel.name]

    def step(self, now: float) -> list[tuple[Channel, float]]:
        """One cycle.

        Args:
            now: s.

        Returns:
            The inputs that changed and their values, in order.

        Raises:
            InvalidInputError: rules that trigger each other without end.
        """
        if not self._heard and self._plc.next_time > now:
            return []
        changes = self._plc.step(now, {})
        for channel, value in self._heard:
            changes += self._plc.step(now, {channel: value})
        self._heard.clear()
        done = []
        for change in changes:
            channel = self._own(change.channel)
            if self._io.set_value(channel, change.value):
                done.append((channel, change.value))
        return done

    def _own(self, channel: Channel) -> Channel:
        return self._io.channel(channel.kind, channel.direction, channel.index)

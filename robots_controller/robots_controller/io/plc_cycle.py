"""PlcCycle: a scripted PLC with an input image, as a PLC works: it reads, then it acts."""

from collections.abc import Mapping

from robots_controller.io.io_image import Channel
from robots_controller.io.plc_script import PlcScript
from robots_controller.io.scripted_plc import InputChange, ScriptedPlc


class PlcCycle:
    """Collects changes of outputs, and acts on them in the next cycle.

    Args:
        script: The rules.
        start: The time at which the PLC starts, s.
    """

    def __init__(self, script: PlcScript, start: float) -> None:
        self._plc = ScriptedPlc(script, start)
        self.outputs = tuple(channel for channel in script.channels if channel.direction == 'output')
        """Outputs of the robot that the script reads."""
        self._last = {channel.name: (channel, 0.0) for channel in self.outputs}
        self._changes: list[tuple[Channel, float]] = []

    @property
    def inputs(self) -> Mapping[Channel, float]:
        """Values of the inputs that the script sets."""
        return self._plc.inputs

    @property
    def next_time(self) -> float:
        """When the PLC acts by itself, s; 0 while a change of an output waits, infinite for never."""
        return 0.0 if self._changes else self._plc.next_time

    def output(self, name: str, value: float) -> None:
        """Take the value of an output such as 'digital_output.1'; outputs of no rule are ignored."""
        channel, last = self._last.get(name, (None, value))
        if channel is not None and value != last:
            self._last[name] = (channel, value)
            self._changes.append((channel, value))

    def step(self, now: float) -> list[InputChange]:
        """One cycle: what was due first, then each change of an output, in the order in which they came.

        Args:
            now: s, not before the last cycle.

        Returns:
            The inputs that changed, in order; one may change several times.

        Raises:
            InvalidInputError: a time before the last cycle, or rules that trigger each other without end.
        """
        outputs, self._changes = self._changes, []
        changes = self._plc.step(now, {})
        for channel, value in outputs:
            changes += self._plc.step(now, {channel: value})
        return changes

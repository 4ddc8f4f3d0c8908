"""SimulatedPlc: the scripted PLC of a simulated cell, and what the controller does for its inputs."""

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.watched_inputs import WatchedInputs
from robots_controller.io.io_image import IoImage, image_sizes
from robots_controller.io.scripted_plc import ScriptedPlc
from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.record.cell_log import CellLog


class SimulatedPlc:
    """Sets the inputs of the program; those that stop the robot or close zones reach the controller too.

    Args:
        parts: Its script, and which inputs do what.
        io: The program's inputs and outputs.
        control: The controller.
        log: Takes the changes.
        start: The time at which it starts, s.
    """

    def __init__(
        self, parts: CellParts, io: IoImage, control: ControlLoop, log: CellLog, start: float
    ) -> None:
        self._io, self._log = io, log
        self._watched = WatchedInputs(control, parts.emergency_stop, parts.zone_inputs)
        self._plc = ScriptedPlc(parts.plc_script, start)
        self.images = image_sizes(self._plc.inputs)
        """Images of its inputs, and the number of inputs in each."""
        log.on_output = self._plc.output

    def begin(self) -> None:
        """Set the inputs as they are at the start."""
        for channel, value in self._plc.inputs.items():
            self._io.set_value(self._io.find(channel.name), value)

    @property
    def next_time(self) -> float:
        """When it acts by itself, s."""
        return self._plc.next_time

    def step(self, now: float) -> bool:
        """Act, now in s; returns whether an input of the program has changed."""
        if self._plc.next_time > now:
            return False
        changed = False
        for change in self._plc.step(now):
            channel = change.channel
            if self._io.set_value(channel, change.value):
                self._log.input(channel, change.value, self.images[channel.image])
                changed = True
        self.watch_inputs()
        return changed

    def watch_inputs(self) -> None:
        """Stop for the digital inputs that are published, and close zones by them."""
        image = self._io.bits('digital_inputs')[: self.images.get('digital_inputs', 0)].tolist()
        self._watched.look(image)

"""plc_node: a scripted PLC, for tests and demonstrations."""

import math
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus

from robots_controller.io.plc_script import PlcScript, read_plc_script
from robots_controller.io.scripted_plc import ScriptedPlc
from robots_controller.nodes.io_images import InputImages, OutputImages
from robots_core.errors import InvalidInputError
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.run import run

IDLE_PERIOD: Final = 3600.0  # s, of a timer that has nothing to do


class PlcNode(RobotNode):
    """Subscribes to the outputs and sets the inputs by the rules of a script.

    On the wall clock it acts at once. In simulated time it acts as a PLC does, once per cycle, on the outputs
    that have come since the last one, in their order.
    """

    phase = Phase.OBSERVE  # after the controller: in the cycle in which outputs are switched on the path

    def __init__(self, **options: Any) -> None:
        super().__init__('plc_node', **options)
        path = self.parameter('script', '', 'YAML file with the rules of the PLC')
        cycle = self.parameter('cycle', 0.004, 'of the PLC in simulated time, s', bounds=(1e-4, 10.0))
        script = read_plc_script(path) if path else PlcScript(())
        self._plc = ScriptedPlc(script, self.now())
        self._inputs = InputImages(self, script.inputs)
        self._timer = self.create_timer(IDLE_PERIOD, self._step, autostart=False)
        self._outputs = OutputImages(self, self._plc.outputs, self._on_outputs)
        for channel, value in self._plc.inputs.items():
            self._inputs.set(channel, value)
        self._inputs.publish()
        self.ready('ready' if path else 'ready; parameter script is empty, no input is set')
        if self.simulated_time:
            self.start_loop(lambda _: self._step(), period=cycle, name='PLC')
        else:
            self._step()

    def _on_outputs(self) -> None:
        for channel in self._plc.outputs:
            value = self._outputs.value(channel)
            if value is not None:
                self._plc.output(channel.name, value)
        if not self.simulated_time:
            self._step()

    def _step(self) -> None:
        now = self.now()
        try:
            changes = self._plc.step(now)
        except InvalidInputError as error:
            self.journal.error(str(error))
            self.report_health(DiagnosticStatus.ERROR, str(error))
            self._timer.cancel()
            return
        for change in changes:
            self._inputs.set(change.channel, change.value)
            self._inputs.publish()
        if not self.simulated_time:
            due = self._plc.next_time - now
            self._timer.timer_period_ns = int(1e9 * (IDLE_PERIOD if due == math.inf else max(1e-4, due)))
            self._timer.reset()


main: Final = partial(run, PlcNode)

"""A plant in a process of its own, which can be killed and frozen.

Run as a script, `plant_process.py modbus|opcua|mqtt PORT`, it is that process: the servers of pymodbus and
asyncua that `plc_node` has, or a broker of amqtt and `plc_node`'s client. It has `digital_input.1` on, and
prints the values of `digital_output.1` as they come.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from threading import Thread
from typing import IO, Any

from plant_partners import MqttPartner, free_port
from robots_controller.io.io_image import Channel
from robots_controller.io.plant.modbus_plc import ModbusPlc
from robots_controller.io.plant.mqtt_plc import MqttPlc
from robots_controller.io.plant.opcua_plc import OpcuaPlc

READY, START = Channel('digital', 'input', 1), Channel('digital', 'output', 1)
PLCS: dict[str, Any] = {'modbus': ModbusPlc, 'mqtt': MqttPlc, 'opcua': OpcuaPlc}


class PlantProcess:
    """The process, which starts again at the same port.

    Args:
        protocol: One of `PLCS`.
    """

    def __init__(self, protocol: str) -> None:
        self.protocol, self.port = protocol, free_port()
        self.heard: list[str] = []
        """Values that have come since the start."""

    def start(self) -> None:
        """Start the process."""
        self.heard = []
        command = [sys.executable, __file__, self.protocol, str(self.port)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self._reader = Thread(target=self._read, args=(self._process.stdout, self.heard), daemon=True)
        self._reader.start()

    def kill(self) -> None:
        """End the process without notice to anyone."""
        self._process.kill()
        self._process.wait()
        self._reader.join()

    @staticmethod
    def _read(lines: IO[str], heard: list[str]) -> None:
        with lines:
            heard.extend(map(str.strip, lines))

    def freeze(self, *, frozen: bool) -> None:
        """Let it do nothing, or continue."""
        self._process.send_signal(signal.SIGSTOP if frozen else signal.SIGCONT)


def main(protocol: str, port: int) -> None:
    """What the process does."""
    if protocol == 'mqtt':
        broker = MqttPartner()
        broker.port = port
        broker.start()
    PLCS[protocol]([READY, START], port, lambda _, value: print(value, flush=True)).set({READY: 1.0})
    signal.pause()


if __name__ == '__main__':
    main(sys.argv[1], int(sys.argv[2]))

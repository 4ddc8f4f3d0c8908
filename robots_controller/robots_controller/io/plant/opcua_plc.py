"""OpcuaPlc: a PLC as an OPC UA server; its variables are named as the robot's channels: digital_input.1."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

from robots_controller.io.io_image import Channel
from robots_controller.io.plant.loop_thread import LoopThread
from robots_controller.io.plant.opcua_frames import start_guarded
from robots_controller.io.plant.plant_link import library
from robots_controller.io.plant.plc_server import HOST, OnWritten, check_port, served_sizes
from robots_core.garbage import garbage_kept

NAMESPACE: Final = 'urn:robots:plc'


class OpcuaPlc:
    """See `PlcServer`; without encryption, and for anyone on this machine."""

    def __init__(self, channels: Iterable[Channel], port: int, on_written: OnWritten) -> None:
        self._forward = on_written
        self._library = library('asyncua', 'asyncua', 'opcua')
        check_port('OPC UA', port)
        self._names: dict[Any, str] = {}
        self._nodes: dict[str, Any] = {}
        self._thread = LoopThread('OPC UA PLC')
        self._server = self._thread.wait(self._open(served_sizes(channels), port))

    async def _open(self, sizes: Mapping[str, int], port: int) -> Any:
        callbacks = library('asyncua.common.callback', 'asyncua', 'opcua')
        ua, server = self._library.ua, self._library.Server()
        with garbage_kept():  # thousands of nodes of the specification
            await server.init()
        server.set_endpoint(f'opc.tcp://{HOST}:{port}')
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        index = await server.register_namespace(NAMESPACE)
        for image, size in sizes.items():
            value = False if image.startswith('digital') else 0.0
            for number in range(1, size + 1):
                name = f'{image.removesuffix("s")}.{number}'
                node = await server.nodes.objects.add_variable(ua.NodeId(name, index), name, value)
                self._nodes[name] = node
                if image.endswith('outputs'):
                    await node.set_writable()
                    self._names[node.nodeid] = name
        server.subscribe_server_callback(callbacks.CallbackType.PostWrite, self._on_written)
        await start_guarded(server)
        return server

    def set(self, values: Mapping[Channel, float]) -> None:
        """See `PlcServer`."""
        self._thread.wait(self._set(values))

    async def _set(self, values: Mapping[Channel, float]) -> None:
        for channel, value in values.items():
            await self._nodes[channel.name].write_value(
                bool(value) if channel.kind == 'digital' else float(value)
            )

    async def _on_written(self, event: Any, _service: Any) -> None:
        if not event.is_external:
            return
        answers, ua = event.response_params, self._library.ua
        for index, node in enumerate(event.request_params.NodesToWrite):
            name = self._names.get(node.NodeId)
            if name is None or not answers[index].is_good():
                continue
            value = float(node.Value.Value.Value)
            if math.isfinite(value):
                self._forward(name, value)
            else:
                answers[index] = ua.StatusCode(ua.StatusCodes.BadOutOfRange)

    def close(self) -> None:
        """See `PlcServer`."""
        if not self._thread.closed:
            self._thread.wait(self._server.stop())
            self._thread.close()

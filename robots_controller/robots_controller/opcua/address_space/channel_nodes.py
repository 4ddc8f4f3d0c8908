"""ChannelNodes: the inputs and outputs of the cell as variables."""

from __future__ import annotations

import asyncio
from typing import Any

from asyncua import ua

from robots_controller.io.io_image import IMAGES, Channel
from robots_controller.opcua.address_space.companion_types import Member
from robots_controller.opcua.address_space.instances import Instances
from robots_controller.pendant.pendant_port import ProgramPort
from robots_controller.pendant.pendant_state import ShownIo
from robots_core.errors import InvalidInputError, NoAnswerError, RobotsError


class ChannelNodes:
    """Adds a variable for each channel when it is known, and keeps its value."""

    def __init__(self, instances: Instances, path: str) -> None:
        self._made, self._path = instances, path
        self._channels: dict[ua.NodeId, Channel] = {}
        self._written: ShownIo | None = None

    async def build(self) -> None:
        """Add the object that has the channels."""
        await self._made.add(self._path, 'AuxiliaryComponentType', optional=('ParameterSet',))
        await self._made.write(f'{self._path}/ProductCode', '')

    async def update(self, io: ShownIo) -> None:
        """Give the channels their values."""
        if io is self._written:
            return
        self._written = io
        for image in IMAGES:
            for channel in io.found(image):
                path = self._path_of(channel)
                if self._made.id(path) not in self._channels:
                    await self._add(path, channel)
                value = io.values[image][channel.index - 1]
                await self._made.write(path, bool(value) if channel.kind == 'digital' else float(value))

    def _path_of(self, channel: Channel) -> str:
        return f'{self._path}/ParameterSet/{channel.name}'

    async def _add(self, path: str, channel: Channel) -> None:
        kind = 'ua:Boolean' if channel.kind == 'digital' else 'ua:Double'
        await self._made.add_variable(
            path,
            Member(channel.name, 0, 'variable', kind),
            ua.QualifiedName(channel.name, self._made.writer.own),
            label=channel.label,
        )
        node = self._made.id(path)
        self._channels[node] = channel
        if channel.direction == 'output':  # for users that may operate
            await self._made.writer.server.get_node(node).set_writable()

    async def take_written(self, port: ProgramPort, nodes: list[Any], answers: list[Any]) -> list[str]:
        """Pass on what a client has written; answers to what is refused are replaced in place.

        Returns:
            What was refused, and why.
        """
        refused = []
        for index, (node, answer) in enumerate(zip(nodes, answers, strict=True)):
            channel = self._channels.get(node.NodeId)
            if channel is None or not answer.is_good():
                continue
            try:
                value = channel.checked(float(node.Value.Value.Value))
                await asyncio.to_thread(port.set_io, channel, value)
            except RobotsError as error:
                answers[index] = ua.StatusCode(_code(error))
                refused.append(f'{channel.name}: {error}')
                await self._made.repeat(self._path_of(channel))
            else:
                self._made.note(self._path_of(channel), node.Value.Value.Value)
        return refused


def _code(error: RobotsError) -> Any:
    if isinstance(error, NoAnswerError):
        return ua.StatusCodes.BadNoCommunication
    invalid = isinstance(error, InvalidInputError)
    return ua.StatusCodes.BadOutOfRange if invalid else ua.StatusCodes.BadInvalidState

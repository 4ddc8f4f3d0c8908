"""TransitionEvents: events of the state machines, as clients of the server object receive them."""

from __future__ import annotations

from asyncua import ua
from asyncua.server.event_generator import EventGenerator

from robots_controller.opcua.address_space.instances import Instances
from robots_controller.opcua.address_space.node_writer import NodeWriter

TYPE = ua.ObjectIds.TransitionEventType


class TransitionEvents:
    """Sends a TransitionEventType (OPC 10000-16) for each transition; its source is the state machine.

    Args:
        instances: Which have the state machines.
        writer: Of the address space.
        name: Of the source, for a person.
    """

    def __init__(self, instances: Instances, writer: NodeWriter, name: str) -> None:
        self._made, self._writer, self._name = instances, writer, name
        self._events = EventGenerator(writer.server.iserver.isession)

    async def build(self, machines: tuple[str, ...]) -> None:
        """Let the server object notify of events, which these state machines generate."""
        await self._events.init(TYPE, add_generates_event=False)
        for machine in machines:
            await self._writer.server.get_node(self._made.id(machine)).add_reference(
                ua.NodeId(TYPE), ua.ObjectIds.GeneratesEvent, bidirectional=False
            )

    async def send(self, machine: str, type_name: str, before: str, transition: str, state: str) -> None:
        """Send the event of a transition.

        Args:
            machine: Path of the state machine.
            type_name: Its type, which declares the others.
            before: The state that it leaves.
            transition: The transition.
            state: The state that it enters.
        """
        event = self._events.event
        event.SourceNode, event.SourceName = self._made.id(machine), self._name
        for field, member in (('FromState', before), ('Transition', transition), ('ToState', state)):
            event.add_property(field, ua.LocalizedText(member), ua.VariantType.LocalizedText)
            node = self._writer.member_id(type_name, member)
            event.add_property(f'{field}/Id', node, ua.VariantType.NodeId)
        await self._events.trigger(message=f'{self._name}: {transition}')

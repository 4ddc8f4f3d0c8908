"""TaskNodes: the objects and methods of the task control."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, Final

from asyncua import ua
from asyncua.server.event_generator import EventGenerator

from robots_controller.opcua.address_space.companion_types import TRANSITION_REASONS
from robots_controller.opcua.address_space.instances import (
    INACTIVE,
    Instances,
    answered,
    argument,
    out_of_range,
    wrong_arguments,
)
from robots_controller.opcua.address_space.program_nodes import ProgramNodes
from robots_controller.opcua.task_control import StopMode, TaskControl, operation_state, ready_state
from robots_controller.pendant.pendant_state import ShownProgram
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError

OPTIONAL: Final = (
    *('ExecutionMode', 'TaskControlOperation', 'MotionDevicesUnderControl', 'PossibleStopModes'),
    *('ConfiguredDefaultStopMode', 'ReadySubstateMachine'),
)
PROGRAM: Final = 'Robot program'
STOP_TEXTS: Final = {StopMode.HOLD: 'Hold', StopMode.END: 'End'}
REASONS: Final = {RunState.FAILED: 'Error', RunState.FINISHED: 'Application'}
"""Of transitions into a state; others are made directly, or from outside by a method."""


class TaskNodes:
    """Adds the nodes, keeps their values, and sends an event (OPC 10000-16) for each transition."""

    def __init__(self, instances: Instances, path: str, programs: ProgramNodes, control: TaskControl) -> None:
        self._made, self._programs, self._control = instances, programs, control
        self.path: Final = path
        self._machine = f'{path}/TaskControlOperation/TaskControlStateMachine'
        self._ready = f'{self._machine}/ReadySubstateMachine'
        self._states: dict[str, str] = {}
        self._from_outside = False
        self._events = EventGenerator(instances.writer.server.iserver.isession)

    async def build(self, device: ua.NodeId) -> None:
        """Add the objects and methods of a program that moves a device."""
        made, server = self._made, self._made.writer.server
        await made.add(self.path, 'TaskControlType', optional=OPTIONAL)
        values = {
            'ComponentName': PROGRAM,
            'ParameterSet/ExecutionMode': 'CYCLE',
            'TaskControlOperation/MotionDevicesUnderControl': [device],
        }
        await made.write_all(self.path, values)
        stops = [_enum_value(int(mode), text) for mode, text in STOP_TEXTS.items()]
        await made.write(f'{self._machine}/ConfiguredDefaultStopMode', int(StopMode.END))
        await made.write(f'{self._machine}/PossibleStopModes', stops)
        await self._events.init(ua.ObjectIds.TransitionEventType, add_generates_event=False)
        for machine in (self._machine, self._ready):
            reasons = [_enum_value(number, text) for number, text in enumerate(TRANSITION_REASONS)]
            await made.write(f'{machine}/LastTransitionReason/EnumValues', reasons)
            await self._write_reason(machine, 'Unknown')
            await made.write(f'{machine}/LastTransition', INACTIVE)  # there was none
            await server.get_node(made.id(machine)).add_reference(
                ua.ObjectIds.TransitionEventType, ua.ObjectIds.GeneratesEvent, bidirectional=False
            )
        await self._add_methods()

    async def _add_methods(self) -> None:
        name = argument('Name', ua.VariantType.String, 'file of the program, below the folder of programs')
        node = argument('Id', ua.VariantType.ExpandedNodeId, 'file of the program, below Programs')
        mode = argument('StopMode', ua.VariantType.Int64, '0, or one of PossibleStopModes')
        control, program = self._control, self._programs.program
        methods: tuple[tuple[str, list[ua.Argument], Callable[..., int]], ...] = (
            (f'{self._machine}/Start', [], control.start),
            (f'{self._machine}/Stop', [mode], control.stop),
            (f'{self._machine}/LoadByName', [name], control.load),
            (f'{self._machine}/LoadByNodeId', [node], lambda id_: control.load(program(id_))),
            (f'{self._machine}/UnloadProgram', [], control.unload),
            (f'{self._machine}/UnloadByName', [name], control.unload),
            (f'{self._machine}/UnloadByNodeId', [node], lambda id_: control.unload(program(id_))),
            (f'{self._ready}/ResetToProgramStart', [], control.reset),
        )
        for path, inputs, work in methods:
            await self._made.add_method(path, inputs, self._answering(inputs, work))

    def _answering(self, inputs: list[ua.Argument], work: Callable[..., int]) -> Callable[..., Any]:
        kinds = [ua.VariantType(one.DataType.Identifier) for one in inputs]

        async def answer(_node: ua.NodeId, *given: ua.Variant) -> Any:
            wrong = wrong_arguments(kinds, given)
            if wrong is not None:
                return wrong
            self._from_outside = True
            try:
                status = await asyncio.to_thread(work, *(one.Value for one in given))
            except InvalidInputError:
                self._from_outside = False
                return out_of_range(len(given))
            self._from_outside = status == 0
            return answered(ua.Variant(int(status), ua.VariantType.Int32))

        return answer

    async def update(self, program: ShownProgram) -> None:
        """Give the nodes the values of the program's state."""
        values = {
            'TaskProgramName': self._control.name(program.path),
            'TaskProgramLoaded': program.state is not RunState.IDLE,
        }
        await self._made.write_all(f'{self.path}/ParameterSet', values)
        reason = REASONS.get(program.state, 'External' if self._from_outside else 'Direct')
        changed = await self._enter(
            self._machine, 'OperationStateMachineType', operation_state(program.state), reason
        )
        ready = ready_state(program.state)
        changed |= await self._enter(self._ready, 'ReadySubstateMachineType', ready, reason)
        if changed:
            self._from_outside = False

    async def _enter(self, machine: str, type_name: str, state: str, reason: str) -> bool:
        before = self._states.get(machine)
        if state == before:
            return False
        self._states[machine] = state
        made, writer = self._made, self._made.writer
        if not state:
            await made.write_all(machine, {'CurrentState': INACTIVE, 'CurrentState/Id': INACTIVE})
            return True
        await made.write(f'{machine}/CurrentState', state)
        await made.write(f'{machine}/CurrentState/Id', writer.member_id(type_name, state))
        if before:
            # What lies between may not have been seen. AtProgramStart has no At in names of transitions.
            before = 'Ready' if (before, state) == ('Idle', 'Executing') else before
            transition = f'{before.removeprefix("At")}To{state.removeprefix("At")}'
            await made.write(f'{machine}/LastTransition', transition)
            await made.write(f'{machine}/LastTransition/Id', writer.member_id(type_name, transition))
            await self._write_reason(machine, reason)
            await self._send_event(machine, type_name, before, transition, state)
        return True

    async def _send_event(
        self, machine: str, type_name: str, before: str, transition: str, state: str
    ) -> None:
        event = self._events.event
        event.SourceNode, event.SourceName = self._made.id(machine), PROGRAM
        for field, member in (('FromState', before), ('Transition', transition), ('ToState', state)):
            event.add_property(field, ua.LocalizedText(member), ua.VariantType.LocalizedText)
            node = self._made.writer.member_id(type_name, member)
            event.add_property(f'{field}/Id', node, ua.VariantType.NodeId)
        await self._events.trigger(message=f'{PROGRAM}: {transition}')

    async def _write_reason(self, machine: str, reason: str) -> None:
        path = f'{machine}/LastTransitionReason'
        await self._made.write(path, TRANSITION_REASONS.index(reason))
        await self._made.write(f'{path}/ValueAsText', reason)


def _enum_value(number: int, text: str) -> ua.EnumValueType:
    return ua.EnumValueType(
        Value=number, DisplayName=ua.LocalizedText(text), Description=ua.LocalizedText(text)
    )

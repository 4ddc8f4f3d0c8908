"""Instances: objects of the specifications' types, the values of their variables, and their methods."""

from __future__ import annotations

import datetime as dt
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Final

from asyncua import ua

from robots_controller.opcua.address_space.companion_types import ENUMERATIONS, Member, all_members
from robots_controller.opcua.address_space.node_writer import PARTS, TYPE_ALONE, NodeWriter, type_of_data

STRUCTURES: Final = {
    name.removeprefix('ua:').removesuffix('Type'): tuple(part for part, _, _ in PARTS[name])
    for name in PARTS
    if name.startswith(('ua:ThreeD', 'ua:Rational'))
}
"""Parts of variables that hold a structure: its members."""
STATE_MACHINES: Final = ('TaskControlStateMachineType', 'ReadySubstateMachineType')
CURRENT_STATE: Final = Member(
    'ua:CurrentState', 0, 'variable', 'ua:LocalizedText', 'ua:FiniteStateVariableType'
)
MISMATCH: Final = ua.StatusCodes.BadTypeMismatch
INACTIVE: Final = object()
"""Value of the states of a state machine that is not active."""


class Instances:
    """Adds objects; the path of a node is that of its browse names, without namespaces."""

    def __init__(self, writer: NodeWriter) -> None:
        self.writer: Final = writer
        self._types: dict[str, str] = {}
        """Data types of variables, by path."""
        self._values: dict[str, Any] = {}

    def id(self, path: str) -> ua.NodeId:
        """The node at a path."""
        return ua.NodeId(path, self.writer.own)

    async def add(
        self,
        path: str,
        type_name: str,
        *,
        parent: ua.NodeId | None = None,
        reference: str = 'ua:HasComponent',
        optional: Collection[str] = (),
        description: str = '',
        name: ua.QualifiedName | None = None,
    ) -> ua.NodeId:
        """Add an object with the members of its type.

        Args:
            path: Of the object.
            type_name: Its type.
            parent: What it belongs to, if that is not the node that its path says.
            reference: From the parent.
            optional: Browse names of the optional members that it has, at any depth.
            description: For a person.
            name: Its browse name; of the own namespace by default.
        """
        attributes = ua.ObjectAttributes()
        attributes.Description = ua.LocalizedText(description) if description else ua.LocalizedText()
        above, _, bare = path.rpartition('/')
        await self.writer.add(
            self.id(path),
            name or ua.QualifiedName(bare, self.writer.own),
            parent or self.id(above),
            attributes,
            reference=reference,
            type_name=type_name,
        )
        members = all_members(type_name)
        if type_name in STATE_MACHINES:
            members = (CURRENT_STATE, *members)
        await self._add_members(path, members, optional)
        return self.id(path)

    async def _add_members(self, path: str, members: Collection[Member], optional: Collection[str]) -> None:
        for member in members:
            bare = member.name.rpartition(':')[2]
            below = f'{path}/{bare}'
            if member.kind == 'method' or member.type in TYPE_ALONE:
                continue
            if member.optional and bare not in optional:
                continue
            if member.kind != 'object':
                await self.add_variable(below, member)
                continue
            addin = 'ua:HasAddIn' if bare == 'TaskControlOperation' else 'ua:HasComponent'
            name = self.writer.browse_name(member.name)
            await self.add(below, member.type, reference=addin, optional=optional, name=name)
            await self._add_members(below, member.members, optional)

    async def add_variable(
        self, path: str, member: Member, name: ua.QualifiedName | None = None, **options: Any
    ) -> None:
        """Add a variable with the parts that its type has; its browse name is the member's by default."""
        name = name or self.writer.browse_name(member.name)
        await self.writer.add_variable(
            self.id(path), name, self.id(path.rpartition('/')[0]), member, **options
        )
        self._types[path] = member.type.removeprefix('ua:')
        for part, kind, data in PARTS.get(member.variable_type, ()):
            below = Member(
                f'ua:{part}', 0, kind, f'ua:{data}', type_of_data(data), is_list=data == 'EnumValueType'
            )
            await self.add_variable(f'{path}/{part}', below)

    async def add_method(self, path: str, inputs: list[ua.Argument], callback: Any) -> None:
        """Add a method of the type of its object, which returns a status.

        `callback` is a coroutine function of the object's node and the arguments, as variants.
        """
        parent, _, name = path.rpartition('/')
        status = argument('Status', ua.VariantType.Int32, '0: done; else why not')
        await self.writer.server.get_node(self.id(parent)).add_method(
            self.id(path), self.writer.browse_name(name), callback, inputs, [status]
        )

    async def delete(self, path: str) -> None:
        """Delete an object and the variables that were added below it."""
        below = [one for one in self._types if one.startswith(f'{path}/')]
        # Nothing but their parents refers to the variables.
        items = [ua.DeleteNodesItem(self.id(one), DeleteTargetReferences=False) for one in below]
        items.append(ua.DeleteNodesItem(self.id(path)))
        for status in await self.writer.server.iserver.isession.delete_nodes(ua.DeleteNodesParameters(items)):
            status.check()
        for one in below:
            del self._types[one]
            self._values.pop(one, None)

    async def write(self, path: str, value: Any) -> None:
        """Give a variable a value, and its parts theirs; nothing happens if it has it.

        The value is as Python has it, the text of an enumeration, or a structure of asyncua.
        """
        if path in self._values and self._values[path] == value:
            return
        self._values[path] = value
        now = dt.datetime.now(dt.UTC)
        data = ua.DataValue(_variant(value, self._types[path]), SourceTimestamp=now)
        if value is INACTIVE:
            status = ua.StatusCode(ua.StatusCodes.BadStateNotActive)
            data = ua.DataValue(StatusCode=status, SourceTimestamp=now)
        await self.writer.server.write_attribute_value(self.id(path), data)
        for part in STRUCTURES.get(self._types[path], ()):
            await self.write(f'{path}/{part}', getattr(value, part))

    async def write_all(self, path: str, values: Mapping[str, Any]) -> None:
        """Give variables below a node their values, by their paths from there; see `write`."""
        for below, value in values.items():
            await self.write(f'{path}/{below}', value)

    def note(self, path: str, value: Any) -> None:
        """Take notice of a value that a client has written."""
        self._values[path] = value

    async def repeat(self, path: str) -> None:
        """Write the value again that a variable had."""
        await self.write(path, self._values.pop(path, None))


def argument(name: str, kind: ua.VariantType, description: str) -> ua.Argument:
    """An argument of a method."""
    return ua.Argument(
        Name=name, DataType=ua.NodeId(kind.value), ValueRank=-1, Description=ua.LocalizedText(description)
    )


def wrong_arguments(kinds: Sequence[ua.VariantType], given: Sequence[ua.Variant]) -> Any:
    """The answer to arguments of a wrong number or type; None where they are right."""
    if len(given) != len(kinds):
        missing = len(given) < len(kinds)
        codes = ua.StatusCodes
        return ua.StatusCode(codes.BadArgumentsMissing if missing else codes.BadTooManyArguments)
    codes = [
        0 if one.VariantType is kind and one.Value is not None and not one.is_array else MISMATCH
        for one, kind in zip(given, kinds, strict=True)
    ]
    return _invalid(codes) if any(codes) else None


def out_of_range(count: int) -> ua.CallMethodResult:
    """The answer to arguments that name nothing that is there."""
    return _invalid(ua.StatusCodes.BadOutOfRange for _ in range(count))


def answered(*outputs: ua.Variant) -> ua.CallMethodResult:
    """The answer of a method that was called."""
    result = ua.CallMethodResult()
    result.OutputArguments = list(outputs)
    return result


def _invalid(codes: Any) -> ua.CallMethodResult:
    result = ua.CallMethodResult()
    result.InputArgumentResults = [ua.StatusCode(code) for code in codes]
    result.StatusCode = ua.StatusCode(ua.StatusCodes.BadInvalidArgument)
    return result


def _variant(value: Any, data: str) -> ua.Variant:
    if value is None:
        return ua.Variant(None, ua.VariantType.Null)
    if data == 'LocalizedText' and isinstance(value, str):
        return ua.Variant(ua.LocalizedText(value), ua.VariantType.LocalizedText)
    if data in ua.VariantType.__members__:
        return ua.Variant(value, ua.VariantType[data])
    if data in ENUMERATIONS:
        return ua.Variant(ENUMERATIONS[data][2].index(value), ua.VariantType.Int32)
    return ua.Variant(value, ua.VariantType.ExtensionObject)

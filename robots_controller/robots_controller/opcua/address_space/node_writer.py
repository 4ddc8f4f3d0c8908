"""NodeWriter: adds the types of the specifications, and nodes of them, to a server's address space."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from asyncua import ua

from robots_controller.opcua.address_space.companion_types import (
    DI,
    ENUMERATIONS,
    OBJECT_TYPES,
    REFERENCE_TYPES,
    ROBOTICS,
    Kind,
    Member,
)

NAMESPACE: Final = 'urn:robots:cell'
"""Of the nodes of the robot."""
TYPE_ALONE: Final = ('ua:StateType', 'ua:TransitionType')
"""Types of members that a type has, and its objects have not."""
PARTS: Final[Mapping[str, tuple[tuple[str, Kind, str], ...]]] = {
    'ua:AnalogUnitType': (('EngineeringUnits', 'property', 'EUInformation'),),
    'ua:MultiStateValueDiscreteType': (
        ('EnumValues', 'property', 'EnumValueType'),
        ('ValueAsText', 'property', 'LocalizedText'),
    ),
    'ua:FiniteStateVariableType': (('Id', 'property', 'NodeId'),),
    'ua:FiniteTransitionVariableType': (('Id', 'property', 'NodeId'),),
    'ua:RationalNumberType': (('Numerator', 'variable', 'Int32'), ('Denominator', 'variable', 'UInt32')),
    'ua:ThreeDCartesianCoordinatesType': tuple((name, 'variable', 'Double') for name in 'XYZ'),
    'ua:ThreeDOrientationType': tuple((name, 'variable', 'Double') for name in 'ABC'),
    'ua:ThreeDFrameType': (
        ('CartesianCoordinates', 'variable', 'ThreeDCartesianCoordinates'),
        ('Orientation', 'variable', 'ThreeDOrientation'),
    ),
}
"""What variables of a type have: name, class and data type; all of namespace 0."""


def type_of_data(data: str) -> str:
    """The type of a variable that holds a structure."""
    return f'ua:{data}Type' if f'ua:{data}Type' in PARTS else 'ua:BaseDataVariableType'


class NodeWriter:
    """Adds nodes to a server; see `companion_types` for their names. `own` is the index of `NAMESPACE`."""

    def __init__(self, server: Any, own: int) -> None:
        self.server = server
        self.own = own
        self._indices: dict[str, int] = {'ua': 0}

    async def add_types(self) -> None:
        """Register the namespaces of the specifications, and add all their types that are used here."""
        self._indices['di'] = await self.server.register_namespace(DI)
        self._indices[''] = await self.server.register_namespace(ROBOTICS)
        references = self.server.get_node(ua.ObjectIds.HierarchicalReferences)
        for name, (_, inverse) in REFERENCE_TYPES.items():
            await references.add_reference_type(
                self.type_id(name), self.browse_name(name), symmetric=False, inversename=inverse
            )
        for name in ENUMERATIONS:
            await self._add_enumeration(name)
        for name, kind in OBJECT_TYPES.items():
            attributes = ua.ObjectTypeAttributes()
            attributes.IsAbstract = kind.abstract
            await self._add_type(name, kind.base, attributes)
        for name, kind in OBJECT_TYPES.items():
            for member in kind.members:
                await self._declare(name, self.type_id(name), member)

    async def _add_type(self, name: str, base: str, attributes: Any) -> None:
        await self.add(
            self.type_id(name),
            self.browse_name(name),
            self.type_id(base),
            attributes,
            reference='ua:HasSubtype',
        )

    async def _declare(self, owner: str, parent: ua.NodeId, member: Member) -> None:
        node, name = self.number(owner, member.number), self.browse_name(member.name)
        if member.kind == 'method':
            await self.add(node, name, parent, ua.MethodAttributes())
        elif member.kind == 'object':
            await self.add(node, name, parent, ua.ObjectAttributes(), type_name=member.type)
        else:
            await self.add_variable(node, name, parent, member)
        if member.type not in TYPE_ALONE:
            await self.server.get_node(node).set_modelling_rule(not member.optional)
        for below in member.members:
            await self._declare(owner, node, below)

    async def _add_enumeration(self, name: str) -> None:
        _, number, texts = ENUMERATIONS[name]
        await self._add_type(name, 'ua:Enumeration', ua.DataTypeAttributes())
        values = ua.Variant([ua.LocalizedText(text) for text in texts], ua.VariantType.LocalizedText)
        await self.add_variable(
            self.number(name, number),
            ua.QualifiedName('EnumStrings'),
            self.type_id(name),
            Member('EnumStrings', number, 'property', 'ua:LocalizedText', is_list=True),
            values,
        )

    def browse_name(self, name: str) -> ua.QualifiedName:
        """The name of a member or type with its namespace."""
        prefix, _, bare = name.rpartition(':')
        return ua.QualifiedName(bare, self._indices[prefix])

    def number(self, name: str, number: int) -> ua.NodeId:
        """The node with a number in the namespace of a name."""
        return ua.NodeId(number, self._indices[name.rpartition(':')[0]])

    def type_id(self, name: str) -> ua.NodeId:
        """Node of a type: of objects, references, data or variables."""
        if name.startswith('ua:'):
            return ua.NodeId(getattr(ua.ObjectIds, name.removeprefix('ua:')))
        if name in OBJECT_TYPES:
            return self.number(name, OBJECT_TYPES[name].number)
        return self.number(name, (REFERENCE_TYPES.get(name) or ENUMERATIONS[name])[0])

    def member_id(self, type_name: str, member: str) -> ua.NodeId:
        """Node of a declaration, such as a state."""
        (found,) = [one for one in OBJECT_TYPES[type_name].members if one.name == member]
        return self.number(type_name, found.number)

    async def add(
        self,
        node: ua.NodeId,
        name: ua.QualifiedName,
        parent: ua.NodeId,
        attributes: Any,
        *,
        reference: str = 'ua:HasComponent',
        type_name: str = '',
        label: str = '',
    ) -> None:
        """Add a node with the attributes of its class; people see its label, by default its browse name."""
        kind = type(attributes).__name__.removesuffix('Attributes')
        attributes.DisplayName = ua.LocalizedText(label or name.Name)
        item = ua.AddNodesItem()
        item.RequestedNewNodeId, item.BrowseName, item.ParentNodeId = node, name, parent
        item.NodeClass, item.NodeAttributes = ua.NodeClass[kind], attributes
        item.ReferenceTypeId = self.type_id(reference)
        if type_name:
            item.TypeDefinition = self.type_id(type_name)
        (result,) = await self.server.iserver.isession.add_nodes([item])
        result.StatusCode.check()

    def own_node(self, given: ua.NodeId) -> ua.NodeId | None:
        """The node of an id, which may be expanded; None where it is not of the own namespace and server."""
        uri, server = getattr(given, 'NamespaceUri', None), getattr(given, 'ServerIndex', None)
        own = uri == NAMESPACE if uri else given.NamespaceIndex == self.own
        return ua.NodeId(given.Identifier, self.own) if own and not server else None

    async def refer(self, source: ua.NodeId, reference: str, target: ua.NodeId) -> None:
        """Add a reference, and its inverse."""
        await self.server.get_node(source).add_reference(target, self.type_id(reference))

    async def add_variable(
        self,
        node: ua.NodeId,
        name: ua.QualifiedName,
        parent: ua.NodeId,
        member: Member,
        value: Any = None,
        *,
        label: str = '',
    ) -> None:
        """Add a variable or property that clients may read; its value is null until it is known."""
        attributes = ua.VariableAttributes()
        attributes.DataType = self.type_id(member.type)
        attributes.Value = value or ua.Variant(None, ua.VariantType.Null)
        attributes.ValueRank = ua.ValueRank.OneDimension if member.is_list else ua.ValueRank.Scalar
        attributes.ArrayDimensions = [0] if member.is_list else None
        is_property = member.kind == 'property'
        await self.add(
            node,
            name,
            parent,
            attributes,
            reference='ua:HasProperty' if is_property else 'ua:HasComponent',
            type_name='ua:PropertyType' if is_property else member.variable_type,
            label=label,
        )

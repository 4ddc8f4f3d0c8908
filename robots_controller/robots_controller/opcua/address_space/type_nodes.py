"""The nodes of the specifications' types."""

from __future__ import annotations

from asyncua import ua

from robots_controller.opcua.address_space.companion_types import (
    ENUMERATIONS,
    OBJECT_TYPES,
    REFERENCE_TYPES,
    Member,
)
from robots_controller.opcua.address_space.node_writer import NodeWriter


async def add_types(writer: NodeWriter) -> None:
    """Add all types that the robot's nodes use."""
    await writer.add_namespaces()
    references = writer.server.get_node(ua.ObjectIds.HierarchicalReferences)
    for name, (_, inverse) in REFERENCE_TYPES.items():
        await references.add_reference_type(
            writer.type_id(name), writer.browse_name(name), symmetric=False, inversename=inverse
        )
    for name in ENUMERATIONS:
        await _add_enumeration(writer, name)
    for name in OBJECT_TYPES:
        kind = OBJECT_TYPES[name]
        attributes = ua.ObjectTypeAttributes()
        attributes.IsAbstract = kind.abstract
        await writer.add(
            writer.type_id(name),
            writer.browse_name(name),
            writer.type_id(kind.base),
            attributes,
            reference='ua:HasSubtype',
        )
    for name, kind in OBJECT_TYPES.items():
        for member in kind.members:
            await _declare(writer, name, writer.type_id(name), member)


async def _declare(writer: NodeWriter, owner: str, parent: ua.NodeId, member: Member) -> None:
    node, name = writer.number(owner, member.number), writer.browse_name(member.name)
    if member.kind == 'method':
        await writer.add(node, name, parent, ua.MethodAttributes())
    elif member.kind == 'object':
        await writer.add(node, name, parent, ua.ObjectAttributes(), type_name=member.type)
    else:
        await writer.add_variable(node, name, parent, member)
    if member.type not in ('ua:StateType', 'ua:TransitionType'):  # of the type alone
        await writer.server.get_node(node).set_modelling_rule(not member.optional)
    for below in member.members:
        await _declare(writer, owner, node, below)


async def _add_enumeration(writer: NodeWriter, name: str) -> None:
    _, number, texts = ENUMERATIONS[name]
    await writer.add(
        writer.type_id(name),
        writer.browse_name(name),
        ua.NodeId(ua.ObjectIds.Enumeration),
        ua.DataTypeAttributes(),
        reference='ua:HasSubtype',
    )
    values = ua.Variant([ua.LocalizedText(text) for text in texts], ua.VariantType.LocalizedText)
    await writer.add_variable(
        writer.number(name, number),
        ua.QualifiedName('EnumStrings'),
        writer.type_id(name),
        Member('EnumStrings', number, 'property', 'ua:LocalizedText', is_list=True),
        values,
    )

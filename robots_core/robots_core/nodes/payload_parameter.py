"""The payload as parameters of a node."""

from __future__ import annotations

from robots_core.blocks.multibody.payload import Payload, payload_of
from robots_core.ros.robot_node import RobotNode


def payload_from_parameters(node: RobotNode, *, read_only: bool = False) -> Payload:
    """Declare parameter `payload` of a node and read it; nothing by default."""
    value = node.parameter(
        'payload',
        [0.0, 0.0, 0.0, 0.0],
        'what hangs on tool0: kg, centre x y z (m), maybe inertia xx xy xz yy yz zz (kg m^2)',
        check=payload_of,
        read_only=read_only,
    )
    return payload_of(value)

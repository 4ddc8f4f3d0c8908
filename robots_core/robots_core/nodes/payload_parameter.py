"""The payload of a node: its parameter, and what programs set."""

import json

from diagnostic_msgs.msg import DiagnosticStatus

from robots_core.blocks.multibody.carried_payload import CarriedPayload
from robots_core.blocks.multibody.payload import Payload, payload_of
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.robot_node import RobotNode


def payload_from_parameters(node: RobotNode) -> Payload:
    """Declare parameter `payload` of a node and read it; nothing by default."""
    payload: Payload = node.parameter(
        'payload',
        [0.0, 0.0, 0.0, 0.0],
        'what hangs on tool0: kg, centre x y z (m), maybe inertia xx xy xz yy yz zz (kg m^2)',
        read=payload_of,
    )
    return payload


def carry_payload(carried: CarriedPayload, settings: DiagnosticStatus) -> None:
    """Carry the payload of a message of `motion_settings`.

    Raises:
        InvalidInputError: it is none.
    """
    text = diagnostic_values(settings).get('payload')
    if text is None:
        return
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidInputError(f'payload = {text[:80]!r} is not JSON: {error}') from None
    if not isinstance(values, list):
        raise InvalidInputError(f'payload = {text[:80]!r} is no list of numbers')
    carried.carry(values)

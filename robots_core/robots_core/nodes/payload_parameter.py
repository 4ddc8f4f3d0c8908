"""The payload of a node: its parameter, and what programs set."""

import json

from diagnostic_msgs.msg import DiagnosticStatus

from robots_core.blocks.multibody.carried_payload import CarriedPayload
from robots_core.blocks.multibody.payload import Payload, payload_of
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.ros.messages import diagnostic_values
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


def carry_payload(node: RobotNode, carried: CarriedPayload, settings: DiagnosticStatus) -> None:
    """Carry the payload of a message of `motion_settings`; one that is not valid is reported."""
    text = diagnostic_values(settings).get('payload')
    if text is None:
        return
    try:
        carried.carry(json.loads(text))
    except (ValueError, TypeError) as error:
        node.refuse('motion_settings', InvalidInputError(f'payload = {text}: {error}'))
    except RobotsError as error:
        node.refuse('motion_settings', error)

"""Parameters that several nodes have."""

import json
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus

from robots_core.blocks.multibody.payload import CarriedPayload, Payload, payload_of
from robots_core.errors import InvalidInputError
from robots_core.periodic.resting_rate import LOWEST, RESTED, RESTING_RATE, RestingRate
from robots_core.pose import Pose
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import finite_vector

PRIORITIES: Final = (0, 99)  # 0 for none
NO_TOOL: Final = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]


def realtime_priority_parameter(node: RobotNode, default: int = 50) -> int:
    """Declare `realtime_priority` of a node's loop and return its value."""
    text = 'FIFO priority of the loop where the system permits it; 0: none'
    priority: int = node.parameter('realtime_priority', default, text, bounds=PRIORITIES)
    return priority


def resting_rate_parameter(node: RobotNode, topic: str, rate: float) -> RestingRate:
    """Declare `resting_rate` of a topic that a loop sends at `rate`, Hz; it says when a message is due."""
    value = node.parameter(
        'resting_rate',
        RESTING_RATE,
        f'{topic} a second of axes that have stood for {RESTED:g} s, Hz, at most `rate`; in simulated time '
        'always `rate`',
        bounds=(LOWEST, 2000.0),
    )
    every = 1 if node.simulated_time else max(1, int(rate / value))
    return RestingRate(every, round(RESTED * rate))


def pose_from_parameter(values: Any) -> Pose:
    """A pose from seven numbers: x, y, z in metres, then quaternion x, y, z, w.

    Raises:
        InvalidInputError: not seven finite numbers, or a quaternion of zero length.
    """
    numbers = finite_vector(values, 7, 'x y z and quaternion x y z w')
    return Pose.from_quaternion(numbers[:3], numbers[3:])


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

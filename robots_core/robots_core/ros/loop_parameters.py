"""Parameters of nodes that work in a loop of their own."""

from typing import Final

from robots_core.periodic.resting_rate import LOWEST, RESTED, RESTING_RATE, RestingRate
from robots_core.ros.robot_node import RobotNode

PRIORITIES: Final = (0, 99)  # 0 for none


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

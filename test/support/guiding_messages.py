"""Messages that guide a robot or a cabin, for bags: (s since the start, topic, message)."""

from __future__ import annotations

from typing import Any

import numpy as np

from robots_controller.simulation.record.ros_messages import BUILD
from written_bags import BAG_START, BAG_TYPES

Row = tuple[float, str, Any]
# Between the periods of the controller, 10 ms, and of jogging, 8 ms.
PERIOD, DELAY = 0.0213, 0.0047  # s between messages, s on their way


def stamp(time: float) -> int:
    return BAG_START + round(1e9 * time)


def times(duration: float) -> list[float]:
    return np.arange(0.0, duration, PERIOD).tolist()


def twists(topic: str, frame: str, duration: float = 0.6) -> list[Row]:
    """A person or a sensor that moves the tool."""
    twist = np.array([0.0, 0.05, -0.02, 0.0, 0.0, 0.1])
    return [(time + DELAY, topic, BUILD.twist_stamped(stamp(time), twist, frame)) for time in times(duration)]


def car_header(time: float) -> Any:
    """The header of a message of a car, at a time in s."""
    stamp = BAG_TYPES.types['builtin_interfaces/msg/Time'](*divmod(round(1e9 * time), 1_000_000_000))
    return BAG_TYPES.types['std_msgs/msg/Header'](stamp, 'car')


def joy(time: float, steering: float, pedal: float) -> Row:
    """A joystick by which a person drives a vehicle."""
    axes, none = np.array([steering, pedal], np.float32), np.zeros(0, np.int32)
    return time, '/joy', BAG_TYPES.types['sensor_msgs/msg/Joy'](car_header(time), axes, none)

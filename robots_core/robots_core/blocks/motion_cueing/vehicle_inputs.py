"""VehicleInputs: messages with a driver's inputs, or with the motion of a vehicle, as plain values."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from robots_core.blocks.motion_cueing.driven_vehicle import DriverInputs
from robots_core.blocks.motion_cueing.vehicle_motion import VehicleMotion
from robots_core.errors import InvalidInputError

INPUTS: Final[Mapping[str, str]] = MappingProxyType(
    {'vehicle_imu': 'sensor_msgs/msg/Imu', 'joy': 'sensor_msgs/msg/Joy'}
)
"""Topics that move a cabin, with their types."""
STEERING, PEDAL = 0, 1
"""Axes of the joystick."""


def read_input(topic: str, message: Any) -> DriverInputs | VehicleMotion:
    """The plain values in a message of one of the `INPUTS`, of rclpy or of rosbags.

    Raises:
        InvalidInputError: a joystick with too few axes, or a number out of range or not finite.
    """
    if topic == 'vehicle_imu':
        f, w = message.linear_acceleration, message.angular_velocity
        return VehicleMotion(np.array([f.x, f.y, f.z]), np.array([w.x, w.y, w.z]))
    axes = [float(value) for value in message.axes]
    if len(axes) <= PEDAL:
        raise InvalidInputError(f'joy has {len(axes)} axes; needed are steering and pedal, in this order')
    return DriverInputs(axes[STEERING], axes[PEDAL])

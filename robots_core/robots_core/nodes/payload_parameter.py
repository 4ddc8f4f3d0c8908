"""The payload as parameters of a node."""

from __future__ import annotations

from typing import Any

import numpy as np

from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import finite_vector


def payload_from_values(values: Any) -> Payload:
    """A payload from four or ten numbers: mass, centre x y z, and inertia xx xy xz yy yz zz if not a point.

    Raises:
        InvalidInputError: another count, values that are not finite, or that no body has.
    """
    count = len(values)
    if count not in {4, 10}:
        raise InvalidInputError(
            f'{count} numbers came; a payload is mass (kg) and centre x y z in tool0 (m), and then maybe '
            f'inertia xx xy xz yy yz zz (kg m^2)'
        )
    mass, x, y, z, *moments = finite_vector(values, count, 'payload').tolist()
    xx, xy, xz, yy, yz, zz = moments or np.zeros(6)
    return Payload(mass, np.array([x, y, z]), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def payload_from_parameters(node: RobotNode, *, read_only: bool = False) -> Payload:
    """Declare parameter `payload` of a node and read it; nothing by default."""
    value = node.parameter(
        'payload',
        [0.0, 0.0, 0.0, 0.0],
        'what hangs on tool0: kg, centre x y z (m), maybe inertia xx xy xz yy yz zz (kg m^2)',
        check=payload_from_values,
        read_only=read_only,
    )
    return payload_from_values(value)

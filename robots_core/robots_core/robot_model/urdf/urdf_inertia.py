"""Masses and inertias that a body can have."""

import numpy as np
import pinocchio as pin

from robots_core.errors import UnknownRobotError

# Of the largest principal moment: what published figures miss 0 by.
ROUNDING = 0.01


def check_inertia(joint: str, body: pin.Inertia) -> None:
    """Refuse what a joint carries if no body has its mass or inertia; nothing at all is taken for a frame.

    Raises:
        UnknownRobotError: a mass that is negative, or 0 with an inertia, or a negative principal moment.
            Moments that break the triangle inequality are taken: some makers publish those alone that
            count in their robot.
    """
    small, middle, large = np.linalg.eigvalsh(body.inertia)
    what = f'the links that joint {joint!r} moves'
    if not body.mass >= 0.0 or (body.mass == 0.0 and large > 0.0):
        raise UnknownRobotError(f'{what} have a mass of {body.mass:g} kg; a body has more than 0 kg')
    if not small >= -ROUNDING * large:
        raise UnknownRobotError(
            f'{what} have principal moments of inertia of {small:g}, {middle:g} and {large:g} kg m^2; a body '
            'has no negative ones'
        )

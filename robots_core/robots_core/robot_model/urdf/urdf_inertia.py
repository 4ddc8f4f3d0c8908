"""Masses and inertias of a URDF that no body has."""

import numpy as np
import pinocchio as pin

from robots_core.errors import UnknownRobotError

# Figures have six digits or more, and sums of them the rounding of doubles.
RELATIVE_ROUNDING = 1e-6  # of the largest principal moment
ROUNDING = 1e-12  # kg m^2


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
    if not small >= -(RELATIVE_ROUNDING * large + ROUNDING):
        raise UnknownRobotError(
            f'{what} have principal moments of inertia of {small:g}, {middle:g} and {large:g} kg m^2; a body '
            'has no negative ones'
        )

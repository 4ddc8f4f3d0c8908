"""What UR arms look like: our own drawing, arm stretched backwards along -x (all joints at zero)."""

import numpy as np

from robots_core.robot_model.shapes import Mesh
from robots_models.families.universal_robots import UniversalRobotsData
from solids import Drawing, body, enlarged, hub, trim, tube, upright

_SILVER = (0.75, 0.77, 0.79)
_DARK = (0.25, 0.27, 0.29)
_BLUE = (0.45, 0.68, 0.85)
_STEEL = (0.82, 0.83, 0.84)

# Distances along y of the arm's tubes from axis 1, m; the wrist's follows from the structural data.
_UPPER_ARM_Y, _FOREARM_Y = -0.136, -0.012


def universal_robots_parts(data: UniversalRobotsData, *, bulk: float = 1.0) -> Drawing:
    """The parts of a UR arm.

    Args:
        data: Its dimensions.
        bulk: How much thicker it is than a UR5e.
    """
    shoulder = data.d1 / bulk
    elbow_x = data.a2 / bulk
    wrist_x = elbow_x + data.a3 / bulk
    wrist_y = -data.d4 / bulk
    hand_z = shoulder - data.d5 / bulk
    flange_y = wrist_y - data.d6 / bulk
    parts: Drawing = {
        body('base', 'base', _SILVER): [upright(0.0, shoulder - 0.085, 0.076, 0.062, chamfer=0.01)],
        trim('base_ring', 'base', _DARK): [
            upright(shoulder - 0.085, shoulder - 0.075, 0.058, 0.058, chamfer=0.002)
        ],
        body('shoulder', 'link_1', _SILVER): [
            upright(shoulder - 0.075, shoulder, 0.061, 0.061, chamfer=0.008),
            hub((0.0, -0.005, shoulder), 'y', 0.061, 0.13, chamfer=0.01),
        ],
        trim('shoulder_cap', 'link_1', _BLUE): [
            hub((0.0, 0.066, shoulder), 'y', 0.056, 0.014, chamfer=0.006)
        ],
        body('upper_arm', 'link_2', _SILVER): [
            hub((0.0, _UPPER_ARM_Y, shoulder), 'y', 0.06, 0.13, chamfer=0.01),
            tube((-0.03, _UPPER_ARM_Y, shoulder), (elbow_x + 0.03, _UPPER_ARM_Y, shoulder), 0.05, 0.045),
            hub((elbow_x, _UPPER_ARM_Y + 0.005, shoulder), 'y', 0.054, 0.125, chamfer=0.01),
        ],
        trim('upper_arm_caps', 'link_2', _BLUE): [
            hub((0.0, _UPPER_ARM_Y - 0.07, shoulder), 'y', 0.055, 0.014, chamfer=0.006),
            hub((elbow_x, _UPPER_ARM_Y - 0.062, shoulder), 'y', 0.049, 0.014, chamfer=0.006),
        ],
        body('forearm', 'link_3', _SILVER): [
            hub((elbow_x, _FOREARM_Y, shoulder), 'y', 0.053, 0.118, chamfer=0.01),
            tube(
                (elbow_x - 0.03, _FOREARM_Y, shoulder), (wrist_x + 0.02, _FOREARM_Y, shoulder), 0.041, 0.036
            ),
            hub((wrist_x, _FOREARM_Y - 0.005, shoulder), 'y', 0.041, 0.1, chamfer=0.008),
        ],
        trim('forearm_caps', 'link_3', _BLUE): [
            hub((elbow_x, _FOREARM_Y + 0.064, shoulder), 'y', 0.049, 0.014, chamfer=0.006),
            hub((wrist_x, _FOREARM_Y + 0.05, shoulder), 'y', 0.037, 0.014, chamfer=0.006),
        ],
        body('wrist_1', 'link_4', _SILVER): _elbow((wrist_x, wrist_y, shoulder), 'y', 'z'),
        trim('wrist_1_cap', 'link_4', _BLUE): [
            hub((wrist_x, wrist_y - 0.049, shoulder), 'y', 0.036, 0.012, chamfer=0.005)
        ],
        body('wrist_2', 'link_5', _SILVER): _elbow((wrist_x, wrist_y, hand_z), 'z', 'y'),
        trim('wrist_2_cap', 'link_5', _BLUE): [
            hub((wrist_x, wrist_y, hand_z - 0.049), 'z', 0.036, 0.012, chamfer=0.005)
        ],
        body('wrist_3', 'link_6', _DARK): [
            tube(
                (wrist_x, wrist_y - 0.052, hand_z),
                (wrist_x, flange_y + 0.01, hand_z),
                0.038,
                0.038,
                chamfer=0.004,
            )
        ],
        body('flange', 'link_6', _STEEL): [
            tube((wrist_x, flange_y + 0.01, hand_z), (wrist_x, flange_y, hand_z), 0.032, 0.032, chamfer=0.002)
        ],
    }
    return enlarged(parts, bulk)


def _elbow(centre: tuple[float, float, float], through: str, out: str) -> tuple[Mesh, ...]:
    """A wrist joint's housing: one cylinder along `through`, one towards -`out`."""
    along, aside = (0.045 * np.eye(3)['xyz'.index(axis)] for axis in (through, out))
    middle = np.array(centre)
    return (
        tube(middle + along, middle - along, 0.04, 0.04, chamfer=0.008),
        tube(middle, middle - aside, 0.039, 0.039, chamfer=0.006),
    )

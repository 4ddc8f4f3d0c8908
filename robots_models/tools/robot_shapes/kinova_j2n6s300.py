"""What Kinova's Jaco 2 looks like: our own drawing, arm upright (all joints at pi)."""

from math import cos, pi, sin
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.robot_model.shapes import Mesh
from robots_models.kinova_j2n6s300.model import KinovaJ2n6s300Data
from solids import Direction, Drawing, body, hub, trim, tube, upright

_DATA = KinovaJ2n6s300Data()
_CARBON = (0.1, 0.1, 0.11)
_GREY = (0.42, 0.43, 0.45)
_SILVER = (0.74, 0.75, 0.77)

_SHOULDER = _DATA.d1
_ELBOW = _SHOULDER + _DATA.d2
_SIDE = -0.0116  # m, where the upper arm's middle lies beside axis 1
_HALF = 0.5 * _DATA.wrist_angle
# The wrist's axes meet in these points and lean 30 degrees to either side.
_WRIST_4 = np.array([0.0, _DATA.e2, _ELBOW + _DATA.d3])
_WRIST_5 = _WRIST_4 + _DATA.d4 * np.array([0.0, sin(_HALF), cos(_HALF)])
_WRIST_6 = _WRIST_5 + _DATA.d5 * np.array([0.0, 1.0, 0.0])
_OUT = np.array([0.0, cos(_HALF), -sin(_HALF)])  # the hand's direction
_PALM = _WRIST_6 + 0.085 * _OUT


def _ring(centre: ArrayLike, direction: ArrayLike | Direction, radius: float) -> Mesh:
    return hub(centre, direction, radius, 0.012, chamfer=0.003)


def _finger(angle: float) -> tuple[Mesh, ...]:
    """A finger of two bones, `angle` about the hand's direction."""
    across = np.cross(_OUT, [1.0, 0.0, 0.0])
    aside = cos(angle) * np.array([1.0, 0.0, 0.0]) + sin(angle) * across
    root, knuckle = _PALM + 0.028 * aside, _PALM + 0.045 * _OUT + 0.05 * aside
    tip = _PALM + 0.1 * _OUT + 0.03 * aside
    return (
        tube(root, knuckle, 0.011, 0.01, chamfer=0.003),
        tube(knuckle, tip, 0.0095, 0.007, chamfer=0.003),
    )


_UP = np.array([0.0, 0.0, 1.0])
_BACK = np.array([0.0, cos(_HALF), sin(_HALF)])

PARTS: Final[Drawing] = {
    body('base', 'base_link', _CARBON): [
        upright(0.0, 0.02, 0.075, 0.07, chamfer=0.005),
        upright(0.015, 0.15, 0.045, 0.043, chamfer=0.006),
    ],
    trim('ring_1', 'link_1', _SILVER): [_ring((0.0, 0.0, 0.157), 'z', 0.042)],
    body('shoulder', 'link_1', _CARBON): [
        upright(0.163, _SHOULDER - 0.01, 0.042, 0.042, chamfer=0.01),
        tube((0.0, -0.002, _SHOULDER), (0.0, 0.058, _SHOULDER), 0.043, 0.038, chamfer=0.01),
    ],
    trim('ring_2', 'link_2', _SILVER): [_ring((0.0, -0.008, _SHOULDER), 'y', 0.043)],
    body('upper_arm', 'link_2', _CARBON): [
        tube((0.0, -0.014, _SHOULDER), (0.0, -0.064, _SHOULDER), 0.043, 0.038, chamfer=0.01),
        upright(_SHOULDER + 0.02, _ELBOW - 0.02, 0.038, 0.034, at=(0.0, _SIDE - 0.02)),
        tube((0.0, -0.008, _ELBOW), (0.0, -0.064, _ELBOW), 0.041, 0.036, chamfer=0.01),
    ],
    trim('ring_3', 'link_3', _SILVER): [_ring((0.0, -0.002, _ELBOW), 'y', 0.041)],
    body('forearm', 'link_3', _CARBON): [
        tube((0.0, 0.004, _ELBOW), (0.0, 0.058, _ELBOW), 0.041, 0.036, chamfer=0.01),
        tube((0.0, 0.018, _ELBOW + 0.015), _WRIST_4 - 0.006 * _UP, 0.036, 0.031, chamfer=0.008),
    ],
    trim('ring_4', 'link_4', _SILVER): [_ring(_WRIST_4, _UP, 0.031)],
    body('wrist_1', 'link_4', _GREY): [
        tube(_WRIST_4 + 0.006 * _UP, _WRIST_4 + 0.05 * _UP, 0.031, 0.031, chamfer=0.008),
        tube(_WRIST_4 + 0.035 * _UP, _WRIST_5 - 0.008 * _OUT, 0.03, 0.03, chamfer=0.008),
    ],
    trim('ring_5', 'link_5', _SILVER): [_ring(_WRIST_5, _BACK, 0.031)],
    body('wrist_2', 'link_5', _GREY): [
        tube(_WRIST_5, _WRIST_5 + 0.045 * _BACK, 0.031, 0.031, chamfer=0.008),
        tube(_WRIST_5 + 0.035 * _BACK, _WRIST_6 - 0.006 * _OUT, 0.03, 0.03, chamfer=0.008),
    ],
    trim('ring_6', 'link_6', _SILVER): [_ring(_WRIST_6, _OUT, 0.031)],
    body('hand', 'link_6', _CARBON): [
        tube(_WRIST_6 + 0.006 * _OUT, _WRIST_6 + 0.05 * _OUT, 0.032, 0.042, chamfer=0.006),
        tube(_WRIST_6 + 0.045 * _OUT, _PALM, 0.044, 0.036, chamfer=0.01),
    ],
    body('finger_1', 'link_6', _GREY): _finger(0.5 * pi),
    body('finger_2', 'link_6', _GREY): _finger(-0.8),
    body('finger_3', 'link_6', _GREY): _finger(pi + 0.8),
}

"""What Bello Bot looks like: round and friendly, drawn with its arm straight up (all joints at zero)."""

from typing import Final

from robots_core.robot_model.shapes import Mesh
from robots_models.bello_bot.model import BelloBotData
from solids import Drawing, body, hub, tapered_arm, trim, tube, upright

_DATA = BelloBotData()
_CREAM = (0.96, 0.94, 0.89)
_TEAL = (0.05, 0.58, 0.6)
_CORAL = (1.0, 0.45, 0.36)
_INK = (0.12, 0.15, 0.2)
_STEEL = (0.78, 0.79, 0.8)

_SHOULDER = _DATA.shoulder_height
_ELBOW = _SHOULDER + _DATA.upper_arm
_WRIST = _ELBOW + _DATA.forearm
_FLANGE = _WRIST + _DATA.hand

# Heights where the bodies turn about their own length: axes 1, 3, 5 and 7.
_TURN_1, _TURN_3, _TURN_5, _TURN_7 = 0.2, 0.66, 1.19, 1.64
_RING = 0.014


def _ring(top: float, radius: float) -> Mesh:
    return upright(top - _RING, top, radius, radius, chamfer=0.004)


def _shell(
    joint: float, height: float, radius_below: float, radius_above: float, *, width: float, chamfer: float
) -> Mesh:
    """The round housing above a joint."""
    ends = (0.0, 0.0, joint), (0.0, 0.0, joint + height)
    return tapered_arm(*ends, radius_below, radius_above, axis='y', width=width, chamfer=chamfer)


PARTS: Final[Drawing] = {
    trim('foot', 'base_link', _INK): [upright(0.0, 0.035, 0.17, 0.165)],
    body('base', 'base_link', _CREAM): [upright(0.03, _TURN_1 - _RING, 0.145, 0.115, chamfer=0.02)],
    trim('base_ring', 'base_link', _CORAL): [_ring(_TURN_1, 0.114)],
    body('chest', 'link_1', _CREAM): [upright(_TURN_1, _SHOULDER - 0.04, 0.115, 0.085, chamfer=0.01)],
    trim('eyes', 'link_1', _INK): [
        tube((0.07, 0.036, 0.285), (0.112, 0.036, 0.29), 0.017, 0.016, chamfer=0.005),
        tube((0.07, -0.036, 0.285), (0.112, -0.036, 0.29), 0.017, 0.016, chamfer=0.005),
    ],
    body('shoulder', 'link_1', _TEAL): [hub((0.0, 0.0, _SHOULDER), 'y', 0.095, 0.23, chamfer=0.02)],
    body('upper_arm', 'link_2', _CREAM): [
        _shell(_SHOULDER, 0.16, 0.118, 0.085, width=0.17, chamfer=0.03),
        upright(_SHOULDER + 0.08, _TURN_3 - _RING, 0.088, 0.08),
    ],
    trim('upper_arm_ring', 'link_2', _CORAL): [_ring(_TURN_3, 0.079)],
    body('upper_arm_end', 'link_3', _CREAM): [upright(_TURN_3, _ELBOW - 0.02, 0.08, 0.066)],
    body('elbow', 'link_3', _TEAL): [hub((0.0, 0.0, _ELBOW), 'y', 0.078, 0.19, chamfer=0.016)],
    body('forearm', 'link_4', _CREAM): [
        _shell(_ELBOW, 0.12, 0.096, 0.07, width=0.14, chamfer=0.025),
        upright(_ELBOW + 0.06, _TURN_5 - _RING, 0.072, 0.065),
    ],
    trim('forearm_ring', 'link_4', _CORAL): [_ring(_TURN_5, 0.064)],
    body('forearm_end', 'link_5', _CREAM): [upright(_TURN_5, _WRIST - 0.02, 0.065, 0.052)],
    body('wrist', 'link_5', _TEAL): [hub((0.0, 0.0, _WRIST), 'y', 0.058, 0.145, chamfer=0.013)],
    body('hand', 'link_6', _CREAM): [
        _shell(_WRIST, 0.06, 0.073, 0.056, width=0.105, chamfer=0.02),
        upright(_WRIST + 0.03, _TURN_7 - _RING, 0.056, 0.052),
    ],
    trim('hand_ring', 'link_6', _CORAL): [_ring(_TURN_7, 0.051)],
    body('hand_end', 'link_7', _TEAL): [upright(_TURN_7, _FLANGE - 0.012, 0.052, 0.047)],
    body('flange', 'link_7', _STEEL): [upright(_FLANGE - 0.012, _FLANGE, 0.042, 0.042, chamfer=0.003)],
}

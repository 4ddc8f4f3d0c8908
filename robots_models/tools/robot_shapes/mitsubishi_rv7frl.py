"""What the Mitsubishi RV-7FRL looks like: our own drawing, arm upright (all joints at zero)."""

from typing import Final

from robots_models.mitsubishi_rv7frl.model import MitsubishiRv7frlData
from solids import Drawing, block, body, fork, hub, plate, tapered_arm, trim, upright

_DATA = MitsubishiRv7frlData()
_WHITE = (0.94, 0.94, 0.93)
_GREY = (0.33, 0.35, 0.38)
_RED = (0.86, 0.09, 0.12)
_STEEL = (0.78, 0.79, 0.8)

_SHOULDER = _DATA.shoulder_height
_ELBOW = _SHOULDER + _DATA.upper_arm
_WRIST = _ELBOW + _DATA.forearm
_FLANGE = _WRIST + _DATA.flange
_A4_X = -_DATA.elbow_offset

PARTS: Final[Drawing] = {
    trim('foot', 'base_link', _GREY): [
        block((-0.03, 0.0, 0.015), (0.3, 0.26, 0.03), rounding=0.04, chamfer=0.004),
        block((-0.16, 0.0, 0.1), (0.14, 0.15, 0.13), rounding=0.02),
    ],
    body('base', 'base_link', _WHITE): [
        block((-0.03, 0.0, 0.1), (0.24, 0.23, 0.14), rounding=0.07, chamfer=0.02),
        upright(0.16, 0.23, 0.11, 0.105),
    ],
    trim('turntable', 'link_1', _GREY): [hub((0.0, 0.0, 0.236), 'z', 0.1, 0.012, chamfer=0.003)],
    body('shoulder', 'link_1', _WHITE): [
        upright(0.242, _SHOULDER - 0.03, 0.105, 0.1, chamfer=0.015),
        plate(
            ((-0.07, 0.0, 0.3), (0.05, 0.0, 0.3), (0.0, 0.0, _SHOULDER)),
            axis='y',
            width=0.14,
            rounding=0.085,
            chamfer=0.02,
        ),
    ],
    trim('shoulder_cap', 'link_1', _GREY): [hub((0.0, -0.075, _SHOULDER), 'y', 0.065, 0.02, chamfer=0.005)],
    trim('mark', 'link_1', _RED): [block((0.1, 0.0, 0.3), (0.014, 0.05, 0.05), rounding=0.01, chamfer=0.004)],
    body('upper_arm', 'link_2', _WHITE): [
        tapered_arm(
            (0.0, 0.115, _SHOULDER), (0.0, 0.115, _ELBOW), 0.085, 0.07, axis='y', width=0.09, chamfer=0.02
        )
    ],
    trim('upper_arm_caps', 'link_2', _GREY): [
        hub((0.0, 0.165, _SHOULDER), 'y', 0.06, 0.016, chamfer=0.005),
        hub((0.0, 0.165, _ELBOW), 'y', 0.048, 0.016, chamfer=0.005),
    ],
    body('elbow', 'link_3', _WHITE): [
        plate(
            ((0.0, 0.0, _ELBOW), (_A4_X - 0.02, 0.0, _ELBOW - 0.03), (_A4_X, 0.0, _ELBOW + 0.1)),
            axis='y',
            width=0.135,
            rounding=0.065,
            chamfer=0.02,
        ),
        upright(_ELBOW + 0.1, _ELBOW + 0.185, 0.064, 0.06, at=(_A4_X, 0.0)),
    ],
    trim('elbow_cap', 'link_3', _GREY): [hub((0.0, -0.07, _ELBOW), 'y', 0.045, 0.02, chamfer=0.005)],
    body('forearm', 'link_4', _WHITE): [
        upright(_ELBOW + 0.19, _WRIST - 0.05, 0.056, 0.046, at=(_A4_X, 0.0)),
        *fork(
            (_A4_X, 0.0, _WRIST - 0.07), (_A4_X, 0.0, _WRIST), 0.042, 0.04, axis='y', aside=0.04, width=0.026
        ),
    ],
    body('hand', 'link_5', _GREY): [
        hub((_A4_X, 0.0, _WRIST), 'y', 0.038, 0.05),
        upright(_WRIST, _FLANGE - 0.022, 0.036, 0.034, at=(_A4_X, 0.0), chamfer=0.006),
    ],
    body('flange', 'link_6', _STEEL): [
        upright(_FLANGE - 0.022, _FLANGE, 0.03, 0.03, at=(_A4_X, 0.0), chamfer=0.003)
    ],
}

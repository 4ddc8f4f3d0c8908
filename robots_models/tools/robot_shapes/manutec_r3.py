"""What the Manutec r3 looks like: our own drawing, arm upright (all joints at zero)."""

from typing import Final

from robots_models.manutec_r3.model import ManutecR3Data
from solids import Drawing, block, body, fork, hub, pedestal, tapered_arm, trim, tube, upright

_DATA = ManutecR3Data()
_RED = (0.78, 0.16, 0.12)
_CREAM = (0.93, 0.9, 0.82)
_GREY = (0.4, 0.41, 0.43)
_BLACK = (0.12, 0.12, 0.13)
_STEEL = (0.78, 0.79, 0.8)

_SHOULDER = _DATA.shoulder_height
_ELBOW = _SHOULDER + _DATA.upper_arm
_WRIST = _ELBOW + _DATA.forearm
_FLANGE = _WRIST + _DATA.flange
_Y2 = -_DATA.shoulder_offset
_Y4 = _Y2 + _DATA.elbow_offset
_ASIDE = 0.17  # m, the upper arm stands beside the column, where its centre of mass is

PARTS: Final[Drawing] = {
    body('foot', 'base_link', _GREY): [
        block((0.0, 0.0, 0.015), (0.62, 0.62, 0.03), rounding=0.08, chamfer=0.004),
        pedestal((0.0, 0.0, 0.03), (0.0, 0.0, 0.26), (0.5, 0.5), (0.4, 0.4), rounding=0.1),
        hub((0.0, 0.0, 0.29), 'z', 0.2, 0.09),
    ],
    trim('turntable', 'link_1', _BLACK): [hub((0.0, 0.0, 0.343), 'z', 0.19, 0.016, chamfer=0.004)],
    body('column', 'link_1', _RED): [
        tube((0.0, 0.0, 0.351), (0.0, -0.04, 0.48), 0.21, 0.2, chamfer=0.02),
        tapered_arm((0.0, -0.02, 0.44), (0.0, _Y2, _SHOULDER), 0.17, 0.14, axis='x', width=0.2),
    ],
    trim('motor_1', 'link_1', _BLACK): [
        hub((0.0, 0.1, 0.58), 'z', 0.075, 0.22),
        hub((0.0, 0.1, 0.7), 'z', 0.055, 0.04),
    ],
    trim('motor_2', 'link_1', _BLACK): [
        hub((-0.17, _Y2, _SHOULDER), 'x', 0.085, 0.16),
        hub((-0.265, _Y2, _SHOULDER), 'x', 0.065, 0.04),
    ],
    body('upper_arm', 'link_2', _CREAM): [
        tapered_arm(
            (_ASIDE, _Y2, _SHOULDER), (_ASIDE, _Y2, _ELBOW), 0.14, 0.1, axis='x', width=0.14, chamfer=0.03
        )
    ],
    trim('upper_arm_caps', 'link_2', _GREY): [
        hub((_ASIDE + 0.075, _Y2, _SHOULDER), 'x', 0.1, 0.03),
        hub((_ASIDE + 0.09, _Y2, _ELBOW), 'x', 0.07, 0.09),
    ],
    body('elbow', 'link_3', _RED): [
        tapered_arm((0.0, _Y2, _ELBOW), (0.0, _Y4, _ELBOW + 0.12), 0.115, 0.1, axis='x', width=0.2),
        upright(_ELBOW + 0.1, _ELBOW + 0.3, 0.1, 0.085, at=(0.0, _Y4), chamfer=0.02),
    ],
    trim('motors_wrist', 'link_3', _BLACK): [
        upright(_ELBOW - 0.02, _ELBOW - 0.22, 0.05, 0.05, at=(-0.05, _Y2 - 0.03)),
        upright(_ELBOW - 0.02, _ELBOW - 0.22, 0.05, 0.05, at=(0.05, _Y2 - 0.03)),
    ],
    body('forearm', 'link_4', _CREAM): [
        upright(_ELBOW + 0.305, _WRIST - 0.08, 0.085, 0.072, at=(0.0, _Y4), chamfer=0.015),
        *fork((0.0, _Y4, _WRIST - 0.1), (0.0, _Y4, _WRIST), 0.06, 0.058, axis='x', aside=0.06, width=0.035),
    ],
    body('hand', 'link_5', _GREY): [
        hub((0.0, _Y4, _WRIST), 'x', 0.056, 0.08),
        upright(_WRIST, _FLANGE - 0.03, 0.052, 0.048, at=(0.0, _Y4), chamfer=0.006),
    ],
    body('flange', 'link_6', _STEEL): [
        upright(_FLANGE - 0.03, _FLANGE, 0.045, 0.045, at=(0.0, _Y4), chamfer=0.004)
    ],
}

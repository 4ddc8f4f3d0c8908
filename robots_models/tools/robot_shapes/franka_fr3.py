"""What the Franka Research 3 looks like: our own drawing, arm upright (all joints at zero)."""

from typing import Final

from robots_models.franka_fr3.model import FrankaFr3Data
from solids import Drawing, block, body, hub, plate, trim, tube, upright

_DATA = FrankaFr3Data()
_WHITE = (0.95, 0.95, 0.95)
_DARK = (0.2, 0.21, 0.23)
_STEEL = (0.78, 0.79, 0.8)

_SHOULDER = _DATA.shoulder_height
_ELBOW = _SHOULDER + _DATA.upper_arm
_WRIST = _ELBOW + _DATA.forearm
_OUT = _DATA.elbow_offset
_A7_X = _DATA.wrist_offset
_FLANGE = _WRIST - _DATA.flange

PARTS: Final[Drawing] = {
    body('foot', 'base_link', _WHITE): [
        block((-0.045, 0.0, 0.03), (0.24, 0.19, 0.06), rounding=0.06, chamfer=0.02),
        upright(0.04, 0.138, 0.088, 0.068, chamfer=0.02),
    ],
    trim('ring_1', 'link_1', _DARK): [hub((0.0, 0.0, 0.145), 'z', 0.06, 0.014, chamfer=0.003)],
    body('shoulder', 'link_1', _WHITE): [
        upright(0.152, _SHOULDER - 0.02, 0.066, 0.062, chamfer=0.015),
        tube((0.0, -0.095, _SHOULDER), (0.0, 0.01, _SHOULDER), 0.05, 0.066, chamfer=0.02),
    ],
    body('upper_arm', 'link_2', _WHITE): [
        tube((0.0, 0.095, _SHOULDER), (0.0, 0.0, _SHOULDER), 0.05, 0.066, chamfer=0.02),
        tube((0.0, 0.02, _SHOULDER), (0.0, 0.0, _SHOULDER + 0.185), 0.064, 0.06, chamfer=0.015),
    ],
    trim('ring_3', 'link_3', _DARK): [hub((0.0, 0.0, _SHOULDER + 0.192), 'z', 0.054, 0.014, chamfer=0.003)],
    body('elbow', 'link_3', _WHITE): [
        tube((0.0, 0.0, _SHOULDER + 0.199), (0.3 * _OUT, 0.0, _ELBOW - 0.03), 0.06, 0.056, chamfer=0.015),
        plate(
            ((0.02, 0.0, _ELBOW - 0.04), (_OUT, 0.0, _ELBOW), (0.03, 0.0, _ELBOW - 0.02)),
            axis='y',
            width=0.1,
            rounding=0.05,
            chamfer=0.02,
        ),
    ],
    trim('elbow_caps', 'link_3', _DARK): [
        hub((_OUT, 0.053, _ELBOW), 'y', 0.04, 0.012, chamfer=0.004),
        hub((_OUT, -0.053, _ELBOW), 'y', 0.04, 0.012, chamfer=0.004),
    ],
    body('forearm', 'link_4', _WHITE): [
        plate(
            ((_OUT, 0.0, _ELBOW), (0.02, 0.0, _ELBOW + 0.06), (0.0, 0.0, _ELBOW + 0.08)),
            axis='y',
            width=0.098,
            rounding=0.048,
            chamfer=0.02,
        ),
        upright(_ELBOW + 0.08, _ELBOW + 0.125, 0.056, 0.056),
    ],
    trim('ring_5', 'link_5', _DARK): [hub((0.0, 0.0, _ELBOW + 0.132), 'z', 0.05, 0.014, chamfer=0.003)],
    # The forearm's lower half hangs to one side, so that the hand can fold back.
    body('forearm_end', 'link_5', _WHITE): [
        tube((0.0, 0.0, _ELBOW + 0.139), (0.0, 0.06, _WRIST - 0.1), 0.055, 0.042, chamfer=0.012),
        upright(_WRIST - 0.12, _WRIST + 0.01, 0.042, 0.046, at=(0.0, 0.075), chamfer=0.015),
        tube((0.0, 0.09, _WRIST), (0.0, 0.0, _WRIST), 0.045, 0.05, chamfer=0.012),
    ],
    body('wrist', 'link_6', _WHITE): [
        tube((0.0, 0.0, _WRIST), (0.0, -0.07, _WRIST), 0.05, 0.045, chamfer=0.012),
        plate(
            ((0.0, 0.0, _WRIST), (_A7_X, 0.0, _WRIST)), axis='y', width=0.085, rounding=0.045, chamfer=0.018
        ),
        upright(_WRIST + 0.045, _WRIST - 0.05, 0.042, 0.046, at=(_A7_X, 0.0)),
    ],
    body('flange', 'link_7', _STEEL): [
        upright(_WRIST - 0.05, _FLANGE + 0.012, 0.044, 0.044, at=(_A7_X, 0.0), chamfer=0.005),
        upright(_FLANGE + 0.012, _FLANGE, 0.032, 0.032, at=(_A7_X, 0.0), chamfer=0.003),
    ],
    trim('flange_button', 'link_7', _DARK): [
        tube(
            (_A7_X + 0.03, 0.0, _WRIST - 0.07),
            (_A7_X + 0.058, 0.0, _WRIST - 0.07),
            0.014,
            0.012,
            chamfer=0.004,
        )
    ],
}

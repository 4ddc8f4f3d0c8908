"""What the debris arm looks like: a satellite with a long arm, straight up (all joints at zero)."""

from typing import Final

from robots_models.debris_arm.model import DebrisArmData
from solids import Drawing, block, body, hub, trim, tube, upright

_DATA = DebrisArmData()
_GOLD = (0.85, 0.65, 0.2)
_PANEL = (0.1, 0.16, 0.4)
_WHITE = (0.94, 0.94, 0.95)
_GREY = (0.45, 0.47, 0.5)
_BLACK = (0.1, 0.1, 0.11)

_SHOULDER = _DATA.shoulder_height
_ELBOW = _SHOULDER + _DATA.upper_arm
_GRIPPER = _ELBOW + _DATA.forearm

PARTS: Final[Drawing] = {
    # The chaser satellite: gold foil, two solar wings, two thrusters behind.
    body('satellite', 'base_link', _GOLD): [
        block((0.0, 0.0, 0.36), (0.7, 0.6, 0.64), rounding=0.03, chamfer=0.02)
    ],
    body('solar_wings', 'base_link', _PANEL): [
        block((0.0, 0.56, 0.5), (0.46, 0.46, 0.02), rounding=0.01, chamfer=0.004),
        block((0.0, -0.56, 0.5), (0.46, 0.46, 0.02), rounding=0.01, chamfer=0.004),
    ],
    trim('thrusters', 'base_link', _BLACK): [
        tube((-0.33, 0.16, 0.3), (-0.48, 0.16, 0.3), 0.04, 0.08, chamfer=0.005),
        tube((-0.33, -0.16, 0.3), (-0.48, -0.16, 0.3), 0.04, 0.08, chamfer=0.005),
    ],
    body('mount', 'base_link', _GREY): [upright(0.66, 0.94, 0.2, 0.13, chamfer=0.015)],
    body('shoulder', 'link_1', _WHITE): [
        upright(0.95, _SHOULDER, 0.125, 0.11),
        hub((0.0, 0.0, _SHOULDER), 'y', 0.12, 0.2, chamfer=0.02),
    ],
    trim('shoulder_caps', 'link_1', _GREY): [
        hub((0.0, 0.12, _SHOULDER), 'y', 0.09, 0.05),
        hub((0.0, -0.12, _SHOULDER), 'y', 0.09, 0.05),
    ],
    body('upper_arm', 'link_2', _WHITE): [
        upright(_SHOULDER + 0.1, _ELBOW - 0.1, 0.075, 0.075),
        hub((0.0, 0.0, _ELBOW), 'y', 0.11, 0.18, chamfer=0.02),
    ],
    trim('upper_arm_bands', 'link_2', _BLACK): [
        hub((0.0, 0.0, _SHOULDER + 0.5), 'z', 0.079, 0.05, chamfer=0.004),
        hub((0.0, 0.0, _ELBOW - 0.5), 'z', 0.079, 0.05, chamfer=0.004),
    ],
    body('forearm', 'link_3', _WHITE): [upright(_ELBOW + 0.09, _GRIPPER - 0.24, 0.066, 0.06)],
    body('wrist', 'link_3', _GREY): [upright(_GRIPPER - 0.25, _GRIPPER - 0.12, 0.085, 0.1)],
    # The gripper that holds a satellite's docking ring.
    body('jaws', 'link_3', _BLACK): [
        block((0.0, 0.07, _GRIPPER - 0.05), (0.08, 0.03, 0.18), rounding=0.01, chamfer=0.005),
        block((0.0, -0.07, _GRIPPER - 0.05), (0.08, 0.03, 0.18), rounding=0.01, chamfer=0.005),
    ],
}

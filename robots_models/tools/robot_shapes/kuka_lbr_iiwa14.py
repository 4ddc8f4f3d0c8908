"""What the KUKA LBR iiwa 14 looks like: our own drawing, arm upright (all joints at zero)."""

from typing import Final

from robots_core.robot_model.shapes import Mesh
from robots_models.kuka_lbr_iiwa14.model import KukaLbrIiwa14Data
from solids import Drawing, body, hub, trim, tube, upright

_DATA = KukaLbrIiwa14Data()
_SILVER = (0.86, 0.87, 0.88)
_ORANGE = (1.0, 0.46, 0.13)
_GREY = (0.45, 0.47, 0.49)
_STEEL = (0.72, 0.73, 0.75)

_SHOULDER = _DATA.shoulder_height
_ELBOW = _SHOULDER + _DATA.upper_arm
_WRIST = _ELBOW + _DATA.forearm
_FLANGE = _WRIST + _DATA.flange

# Heights where the bodies turn about the arm's own length: axes 1, 3, 5 and 7.
_TURN_1, _TURN_3, _TURN_5, _TURN_7 = 0.1575, 0.58, 0.98, 1.261


def _ring(z: float, radius: float) -> Mesh:
    return hub((0.0, 0.0, z), 'z', radius, 0.012, chamfer=0.003)


PARTS: Final[Drawing] = {
    body('base', 'base_link', _GREY): [
        upright(0.0, 0.03, 0.115, 0.115, chamfer=0.005),
        upright(0.025, _TURN_1 - 0.004, 0.105, 0.085, chamfer=0.01),
        tube((-0.06, 0.0, 0.06), (-0.16, 0.0, 0.05), 0.045, 0.04, chamfer=0.006),
    ],
    trim('ring_1', 'link_1', _ORANGE): [_ring(_TURN_1, 0.081)],
    body('shoulder', 'link_1', _SILVER): [
        tube((0.0, 0.0, _TURN_1 + 0.004), (0.0, -0.02, _SHOULDER - 0.06), 0.083, 0.078, chamfer=0.015),
        tube((0.0, -0.105, _SHOULDER), (0.0, 0.0, _SHOULDER), 0.062, 0.088, chamfer=0.025),
    ],
    body('upper_arm', 'link_2', _SILVER): [
        tube((0.0, 0.105, _SHOULDER), (0.0, 0.0, _SHOULDER), 0.062, 0.088, chamfer=0.025),
        tube((0.0, 0.03, _SHOULDER + 0.02), (0.0, 0.0, _TURN_3 - 0.004), 0.078, 0.071, chamfer=0.015),
    ],
    trim('ring_3', 'link_3', _ORANGE): [_ring(_TURN_3, 0.07)],
    body('elbow', 'link_3', _SILVER): [
        tube((0.0, 0.0, _TURN_3 + 0.004), (0.0, 0.02, _ELBOW - 0.05), 0.072, 0.068, chamfer=0.015),
        tube((0.0, 0.095, _ELBOW), (0.0, 0.0, _ELBOW), 0.055, 0.079, chamfer=0.022),
    ],
    body('forearm', 'link_4', _SILVER): [
        tube((0.0, -0.095, _ELBOW), (0.0, 0.0, _ELBOW), 0.055, 0.079, chamfer=0.022),
        tube((0.0, -0.025, _ELBOW + 0.02), (0.0, 0.0, _TURN_5 - 0.004), 0.069, 0.062, chamfer=0.015),
    ],
    trim('ring_5', 'link_5', _ORANGE): [_ring(_TURN_5, 0.06)],
    body('forearm_end', 'link_5', _SILVER): [
        tube((0.0, 0.0, _TURN_5 + 0.004), (0.0, -0.03, _WRIST - 0.05), 0.062, 0.05, chamfer=0.012),
        upright(_WRIST - 0.08, _WRIST + 0.05, 0.045, 0.045, at=(0.0, -0.075), chamfer=0.015),
    ],
    body('hand', 'link_6', _SILVER): [
        hub((0.0, 0.012, _WRIST), 'y', 0.062, 0.085, chamfer=0.02),
        upright(_WRIST, _TURN_7 - 0.004, 0.056, 0.048, chamfer=0.01),
    ],
    trim('ring_7', 'link_7', _ORANGE): [_ring(_TURN_7, 0.042)],
    body('flange', 'link_7', _STEEL): [upright(_TURN_7 + 0.004, _FLANGE, 0.046, 0.042, chamfer=0.005)],
}

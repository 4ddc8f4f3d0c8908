"""What Cello Bot looks like: a cello on its stand, its bow arm stretched forward (all joints at zero)."""

from typing import Final

from robots_models.cello_bot.model import CelloBotData
from solids import Drawing, block, body, fork, hub, plate, tapered_arm, trim, tube, upright

_DATA = CelloBotData()
_VARNISH = (0.55, 0.24, 0.1)
_SPRUCE = (0.8, 0.5, 0.24)
_EBONY = (0.1, 0.09, 0.09)
_IVORY = (0.95, 0.93, 0.87)
_BRASS = (0.8, 0.65, 0.3)

_Z = _DATA.lowest_carriage
_TOP = _Z + _DATA.stroke
_RAIL_X = 0.11
_J2_X = _DATA.neck_offset + _DATA.shoulder_offset
_J3_X = _J2_X + _DATA.upper_arm
_J4_X = _J3_X + _DATA.forearm
_FLANGE_X = _J4_X + _DATA.hand
_ARM_Z = _Z + _DATA.elbow_rise

PARTS: Final[Drawing] = {
    trim('stand', 'base_link', _EBONY): [
        upright(0.0, 0.025, 0.2, 0.195, chamfer=0.006),
        upright(0.02, 0.16, 0.018, 0.024, at=(-0.05, 0.0), chamfer=0.004),
    ],
    # Two bouts and a waist.
    body('body', 'base_link', _VARNISH): [
        hub((-0.05, 0.0, 0.34), 'x', 0.2, 0.12, chamfer=0.02),
        hub((-0.05, 0.0, 0.66), 'x', 0.155, 0.12, chamfer=0.02),
        block((-0.05, 0.0, 0.52), (0.118, 0.22, 0.3), axis='x', rounding=0.05, chamfer=0.02),
    ],
    trim('belly', 'base_link', _SPRUCE): [
        hub((0.011, 0.0, 0.34), 'x', 0.175, 0.012, chamfer=0.004),
        hub((0.011, 0.0, 0.66), 'x', 0.13, 0.012, chamfer=0.004),
    ],
    body('neck', 'base_link', _EBONY): [
        block((0.05, 0.0, 0.84), (0.06, 0.06, 0.9), rounding=0.012, chamfer=0.006),
        tube((0.03, 0.0, _TOP + 0.08), (-0.02, 0.0, _TOP + 0.16), 0.03, 0.028),
        hub((-0.02, 0.0, _TOP + 0.17), 'y', 0.045, 0.05, chamfer=0.01),
    ],
    trim('pegs', 'base_link', _BRASS): [
        hub((0.02, 0.0, _TOP + 0.06), 'y', 0.009, 0.16, chamfer=0.003),
        hub((0.02, 0.0, _TOP + 0.02), 'y', 0.009, 0.16, chamfer=0.003),
    ],
    trim('rails', 'base_link', _BRASS): [
        upright(0.42, _TOP + 0.08, 0.007, 0.007, at=(_RAIL_X - 0.02, 0.022), chamfer=0.002),
        upright(0.42, _TOP + 0.08, 0.007, 0.007, at=(_RAIL_X - 0.02, -0.022), chamfer=0.002),
    ],
    body('carriage', 'link_1', _IVORY): [
        block((_RAIL_X + 0.03, 0.0, _Z), (0.09, 0.13, 0.15), rounding=0.02),
        plate(
            ((_RAIL_X + 0.04, 0.0, _Z - 0.045), (_J2_X, 0.0, _Z - 0.045)),
            axis='z',
            width=0.05,
            rounding=0.055,
        ),
    ],
    body('upper_arm', 'link_2', _VARNISH): [
        tapered_arm((_J2_X, 0.0, _Z + 0.01), (_J3_X, 0.0, _Z + 0.01), 0.06, 0.05, axis='z', width=0.055)
    ],
    trim('upper_arm_cap', 'link_2', _EBONY): [hub((_J2_X, 0.0, _Z + 0.045), 'z', 0.045, 0.02, chamfer=0.005)],
    body('forearm', 'link_3', _VARNISH): [
        tapered_arm((_J3_X, 0.0, _ARM_Z), (_J4_X - 0.05, 0.0, _ARM_Z), 0.05, 0.034, axis='z', width=0.05),
        *fork(
            (_J4_X - 0.05, 0.0, _ARM_Z),
            (_J4_X, 0.0, _ARM_Z),
            0.03,
            0.03,
            axis='y',
            aside=0.028,
            width=0.02,
            chamfer=0.006,
        ),
    ],
    trim('forearm_cap', 'link_3', _EBONY): [
        hub((_J3_X, 0.0, _ARM_Z + 0.03), 'z', 0.038, 0.02, chamfer=0.005)
    ],
    body('wrist', 'link_4', _IVORY): [
        hub((_J4_X, 0.0, _ARM_Z), 'y', 0.026, 0.034, chamfer=0.006),
        tube((_J4_X, 0.0, _ARM_Z), (_J4_X + 0.12, 0.0, _ARM_Z), 0.024, 0.024, chamfer=0.005),
    ],
    body('flange', 'link_5', _BRASS): [
        tube((_J4_X + 0.12, 0.0, _ARM_Z), (_FLANGE_X, 0.0, _ARM_Z), 0.03, 0.026, chamfer=0.004)
    ],
}

"""What the KUKA QUANTEC looks like: our own drawing, arm stretched forward (all joints at zero)."""

from __future__ import annotations

from typing import Final

from robots_models.kuka_kr210_r2700.model import KukaKr210R2700Data
from robots_models.shape_generation import Part, block, hub, pedestal, plate, tapered_arm, tube

_DATA = KukaKr210R2700Data()
_ORANGE = (1.0, 0.46, 0.13)  # about RAL 2003
_ANTHRACITE = (0.17, 0.18, 0.19)
_BLACK = (0.09, 0.09, 0.1)
_GREY = (0.55, 0.57, 0.59)
_STEEL = (0.78, 0.79, 0.8)

_A2_X, _A2_Z = _DATA.axis_1_to_axis_2, _DATA.axis_2_height
_A3_X = _A2_X + _DATA.upper_arm
_A4_Z = _A2_Z + _DATA.elbow_offset
_A5_X = _A2_X + _DATA.upper_arm + _DATA.forearm
_FLANGE_X = _A5_X + _DATA.flange

PARTS: Final = (
    # The foot on its plate.
    Part(
        'base_plate',
        'base_link',
        _GREY,
        (block((0.0, 0.0, 0.012), (0.9, 0.86, 0.024), rounding=0.08, chamfer=0.004),),
    ),
    Part(
        'foot',
        'base_link',
        _ANTHRACITE,
        (
            pedestal((-0.02, 0.0, 0.024), (0.0, 0.0, 0.2), (0.76, 0.68), (0.6, 0.58), rounding=0.12),
            hub((0.0, 0.0, 0.23), 'z', 0.3, 0.1),
            block((-0.37, 0.0, 0.13), (0.16, 0.34, 0.16)),
        ),
        collision=True,
    ),
    # The rotating column: a turntable, and two cheeks that carry axis 2.
    Part('turntable', 'link_1', _ORANGE, (hub((0.0, 0.0, 0.325), 'z', 0.37, 0.1),)),
    Part(
        'column',
        'link_1',
        _ORANGE,
        (
            plate(
                ((-0.22, 0.2, 0.4), (0.36, 0.2, 0.42), (_A2_X + 0.02, 0.2, _A2_Z), (-0.1, 0.2, 0.62)),
                axis='y',
                width=0.17,
                rounding=0.12,
                chamfer=0.025,
            ),
            plate(
                ((-0.24, -0.06, 0.4), (0.22, -0.06, 0.4), (0.06, -0.06, 0.56), (-0.14, -0.06, 0.6)),
                axis='y',
                width=0.42,
                rounding=0.11,
                chamfer=0.025,
            ),
        ),
        collision=True,
    ),
    Part(
        'motor_1',
        'link_1',
        _BLACK,
        (hub((-0.14, -0.14, 0.74), 'z', 0.09, 0.24), hub((-0.14, -0.14, 0.87), 'z', 0.07, 0.05)),
    ),
    Part(
        'motor_2',
        'link_1',
        _BLACK,
        (hub((_A2_X, 0.37, _A2_Z), 'y', 0.11, 0.2), hub((_A2_X, 0.49, _A2_Z), 'y', 0.09, 0.06)),
    ),
    Part('gear_2', 'link_1', _ANTHRACITE, (hub((_A2_X, 0.21, _A2_Z), 'y', 0.2, 0.2),)),
    # The counterbalance runs beside the arm, from the column to the upper arm's hub.
    Part(
        'counterbalance',
        'link_1',
        _ANTHRACITE,
        (
            tube((-0.42, -0.3, 0.57), (0.16, -0.3, 0.64), 0.095, 0.095),
            tube((-0.45, -0.3, 0.566), (-0.41, -0.3, 0.571), 0.075, 0.075, chamfer=0.006),
        ),
        collision=True,
    ),
    Part(
        'counterbalance_rod',
        'link_1',
        _STEEL,
        (tube((0.14, -0.3, 0.637), (0.27, -0.3, 0.653), 0.035, 0.035, chamfer=0.004),),
    ),
    # The upper arm, between the hubs of axes 2 and 3.
    Part(
        'upper_arm',
        'link_2',
        _ORANGE,
        (
            tapered_arm(
                (_A2_X, -0.01, _A2_Z), (_A3_X, -0.01, _A2_Z), 0.205, 0.165, axis='y', width=0.22, chamfer=0.04
            ),
            hub((_A2_X, -0.03, _A2_Z), 'y', 0.215, 0.24, chamfer=0.02),
            hub((_A3_X, 0.0, _A2_Z), 'y', 0.175, 0.26, chamfer=0.02),
        ),
        collision=True,
    ),
    Part(
        'upper_arm_caps',
        'link_2',
        _ANTHRACITE,
        (
            hub((_A2_X, -0.17, _A2_Z), 'y', 0.14, 0.06),
            hub((_A3_X, -0.14, _A2_Z), 'y', 0.12, 0.04),
            tapered_arm(
                (_A2_X - 0.02, -0.26, _A2_Z + 0.006),
                (_A2_X + 0.02, -0.26, _A2_Z),
                0.06,
                0.06,
                axis='y',
                width=0.2,
            ),
        ),
    ),
    # The forearm: the elbow's casting with the motors of the wrist behind it, then the tube.
    Part(
        'elbow',
        'link_3',
        _ORANGE,
        (
            plate(
                (
                    (_A3_X - 0.12, 0.21, _A2_Z + 0.02),
                    (_A3_X + 0.06, 0.21, _A2_Z - 0.02),
                    (_A3_X + 0.12, 0.21, _A4_Z + 0.02),
                    (_A3_X - 0.16, 0.21, _A4_Z + 0.04),
                ),
                axis='y',
                width=0.17,
                rounding=0.11,
                chamfer=0.025,
            ),
            block((_A3_X - 0.01, 0.02, _A4_Z + 0.1), (0.42, 0.4, 0.2), axis='x', rounding=0.08),
            hub((_A3_X + 0.24, 0.0, _A4_Z), 'x', 0.155, 0.2, chamfer=0.02),
        ),
        collision=True,
    ),
    Part(
        'motor_3',
        'link_3',
        _BLACK,
        (hub((_A3_X, 0.36, _A2_Z), 'y', 0.1, 0.16), hub((_A3_X, 0.46, _A2_Z), 'y', 0.08, 0.06)),
    ),
    Part(
        'wrist_motors',
        'link_3',
        _BLACK,
        (
            tube((_A3_X - 0.44, -0.11, _A4_Z + 0.1), (_A3_X - 0.2, -0.11, _A4_Z + 0.1), 0.06, 0.065),
            tube((_A3_X - 0.44, 0.03, _A4_Z + 0.12), (_A3_X - 0.2, 0.03, _A4_Z + 0.12), 0.06, 0.065),
            tube((_A3_X - 0.44, 0.17, _A4_Z + 0.1), (_A3_X - 0.2, 0.17, _A4_Z + 0.1), 0.06, 0.065),
        ),
        collision=True,
    ),
    Part(
        'forearm',
        'link_4',
        _ORANGE,
        (
            tube((_A3_X + 0.35, 0.0, _A4_Z), (_A3_X + 0.6, 0.0, _A4_Z), 0.15, 0.115, chamfer=0.015),
            tube((_A3_X + 0.58, 0.0, _A4_Z), (_A5_X - 0.17, 0.0, _A4_Z), 0.115, 0.105),
        ),
        collision=True,
    ),
    # The in-line wrist: black fork, hand and flange.
    Part(
        'fork',
        'link_4',
        _BLACK,
        (
            tube((_A5_X - 0.24, 0.0, _A4_Z), (_A5_X - 0.1, 0.0, _A4_Z), 0.125, 0.12),
            tapered_arm((_A5_X - 0.14, 0.105, _A4_Z), (_A5_X, 0.105, _A4_Z), 0.1, 0.1, axis='y', width=0.05),
            tapered_arm(
                (_A5_X - 0.14, -0.105, _A4_Z), (_A5_X, -0.105, _A4_Z), 0.1, 0.1, axis='y', width=0.05
            ),
        ),
        collision=True,
    ),
    Part(
        'hand',
        'link_5',
        _ANTHRACITE,
        (
            hub((_A5_X, 0.0, _A4_Z), 'y', 0.105, 0.15),
            tube((_A5_X + 0.02, 0.0, _A4_Z), (_FLANGE_X - 0.05, 0.0, _A4_Z), 0.098, 0.09),
        ),
        collision=True,
    ),
    Part(
        'flange',
        'link_6',
        _STEEL,
        (
            tube((_FLANGE_X - 0.05, 0.0, _A4_Z), (_FLANGE_X - 0.012, 0.0, _A4_Z), 0.07, 0.07, chamfer=0.004),
            tube((_FLANGE_X - 0.012, 0.0, _A4_Z), (_FLANGE_X, 0.0, _A4_Z), 0.08, 0.08, chamfer=0.003),
        ),
        collision=True,
    ),
)
DRAWING_POSTURE: Final = (0.0,) * 6

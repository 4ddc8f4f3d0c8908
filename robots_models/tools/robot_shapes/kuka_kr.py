"""What KUKA's KR robots look like: our own drawing, arm stretched forward (all joints at zero)."""

from robots_models.families.kuka_kr import KukaKrData
from solids import Drawing, block, body, enlarged, fork, hub, pedestal, plate, tapered_arm, trim, tube

_ORANGE = (1.0, 0.46, 0.13)  # about RAL 2003
_ANTHRACITE = (0.17, 0.18, 0.19)
_BLACK = (0.09, 0.09, 0.1)
_GREY = (0.55, 0.57, 0.59)
_STEEL = (0.78, 0.79, 0.8)

_COLUMN = 0.645  # m, axis 2's height in the drawing; a higher axis stands on a higher foot


def kuka_kr_parts(data: KukaKrData, *, bulk: float = 1.0) -> Drawing:
    """The parts of a KR robot.

    Args:
        data: Its dimensions.
        bulk: How much thicker its castings are than those of a KR 210.
    """
    a2_x, a2_z = data.axis_1_to_axis_2 / bulk, data.axis_2_height / bulk
    a3_x = a2_x + data.upper_arm / bulk
    a4_z = a2_z + data.elbow_offset / bulk
    a5_x = a2_x + data.upper_arm / bulk + data.forearm / bulk
    flange_x = a5_x + data.flange / bulk
    lift = a2_z - _COLUMN

    parts: Drawing = {
        # The foot on its plate.
        trim('base_plate', 'base_link', _GREY): [
            block((0.0, 0.0, 0.012), (0.9, 0.86, 0.024), rounding=0.08, chamfer=0.004)
        ],
        body('foot', 'base_link', _ANTHRACITE): [
            pedestal((-0.02, 0.0, 0.024), (0.0, 0.0, 0.2 + lift), (0.76, 0.68), (0.6, 0.58), rounding=0.12),
            hub((0.0, 0.0, 0.23 + lift), 'z', 0.3, 0.1),
            block((-0.37, 0.0, 0.13), (0.16, 0.34, 0.16)),
        ],
        # The rotating column: a turntable, and two cheeks that carry axis 2.
        trim('turntable', 'link_1', _ORANGE): [hub((0.0, 0.0, 0.325 + lift), 'z', 0.37, 0.1)],
        body('column', 'link_1', _ORANGE): [
            plate(
                (
                    (-0.22, 0.2, 0.4 + lift),
                    (0.36, 0.2, 0.42 + lift),
                    (a2_x + 0.02, 0.2, a2_z),
                    (-0.1, 0.2, 0.62 + lift),
                ),
                axis='y',
                width=0.17,
                rounding=0.12,
                chamfer=0.025,
            ),
            plate(
                (
                    (-0.24, -0.06, 0.4 + lift),
                    (0.22, -0.06, 0.4 + lift),
                    (0.06, -0.06, 0.56 + lift),
                    (-0.14, -0.06, 0.6 + lift),
                ),
                axis='y',
                width=0.42,
                rounding=0.11,
                chamfer=0.025,
            ),
        ],
        trim('motor_1', 'link_1', _BLACK): [
            hub((-0.14, -0.14, 0.74 + lift), 'z', 0.09, 0.24),
            hub((-0.14, -0.14, 0.87 + lift), 'z', 0.07, 0.05),
        ],
        trim('motor_2', 'link_1', _BLACK): [
            hub((a2_x, 0.37, a2_z), 'y', 0.11, 0.2),
            hub((a2_x, 0.49, a2_z), 'y', 0.09, 0.06),
        ],
        trim('gear_2', 'link_1', _ANTHRACITE): [hub((a2_x, 0.21, a2_z), 'y', 0.2, 0.2)],
        # The counterbalance runs beside the arm, from the column to the upper arm's hub.
        body('counterbalance', 'link_1', _ANTHRACITE): [
            tube((-0.42, -0.3, 0.57 + lift), (0.16, -0.3, 0.64 + lift), 0.095, 0.095),
            tube((-0.45, -0.3, 0.566 + lift), (-0.41, -0.3, 0.571 + lift), 0.075, 0.075, chamfer=0.006),
        ],
        trim('counterbalance_rod', 'link_1', _STEEL): [
            tube((0.14, -0.3, 0.637 + lift), (0.27, -0.3, 0.653 + lift), 0.035, 0.035, chamfer=0.004)
        ],
        # The upper arm, between the hubs of axes 2 and 3.
        body('upper_arm', 'link_2', _ORANGE): [
            tapered_arm(
                (a2_x, -0.01, a2_z), (a3_x, -0.01, a2_z), 0.205, 0.165, axis='y', width=0.22, chamfer=0.04
            ),
            hub((a2_x, -0.03, a2_z), 'y', 0.215, 0.24, chamfer=0.02),
            hub((a3_x, 0.0, a2_z), 'y', 0.175, 0.26, chamfer=0.02),
        ],
        trim('upper_arm_caps', 'link_2', _ANTHRACITE): [
            hub((a2_x, -0.17, a2_z), 'y', 0.14, 0.06),
            hub((a3_x, -0.14, a2_z), 'y', 0.12, 0.04),
            tapered_arm(
                (a2_x - 0.02, -0.26, a2_z + 0.006),
                (a2_x + 0.02, -0.26, a2_z),
                0.06,
                0.06,
                axis='y',
                width=0.2,
            ),
        ],
        # The forearm: the elbow's casting with the motors of the wrist behind it, then the tube.
        body('elbow', 'link_3', _ORANGE): [
            plate(
                (
                    (a3_x - 0.12, 0.21, a2_z + 0.02),
                    (a3_x + 0.06, 0.21, a2_z - 0.02),
                    (a3_x + 0.12, 0.21, a4_z + 0.02),
                    (a3_x - 0.16, 0.21, a4_z + 0.04),
                ),
                axis='y',
                width=0.17,
                rounding=0.11,
                chamfer=0.025,
            ),
            block((a3_x - 0.01, 0.02, a4_z + 0.1), (0.42, 0.4, 0.2), axis='x', rounding=0.08),
            hub((a3_x + 0.24, 0.0, a4_z), 'x', 0.155, 0.2, chamfer=0.02),
        ],
        trim('motor_3', 'link_3', _BLACK): [
            hub((a3_x, 0.36, a2_z), 'y', 0.1, 0.16),
            hub((a3_x, 0.46, a2_z), 'y', 0.08, 0.06),
        ],
        body('wrist_motors', 'link_3', _BLACK): [
            tube((a3_x - 0.44, -0.11, a4_z + 0.1), (a3_x - 0.2, -0.11, a4_z + 0.1), 0.06, 0.065),
            tube((a3_x - 0.44, 0.03, a4_z + 0.12), (a3_x - 0.2, 0.03, a4_z + 0.12), 0.06, 0.065),
            tube((a3_x - 0.44, 0.17, a4_z + 0.1), (a3_x - 0.2, 0.17, a4_z + 0.1), 0.06, 0.065),
        ],
        body('forearm', 'link_4', _ORANGE): [
            tube((a3_x + 0.35, 0.0, a4_z), (a3_x + 0.6, 0.0, a4_z), 0.15, 0.115, chamfer=0.015),
            tube((a3_x + 0.58, 0.0, a4_z), (a5_x - 0.17, 0.0, a4_z), 0.115, 0.105),
        ],
        # The in-line wrist: black fork, hand and flange.
        body('fork', 'link_4', _BLACK): [
            tube((a5_x - 0.24, 0.0, a4_z), (a5_x - 0.17, 0.0, a4_z), 0.12, 0.115),
            *fork((a5_x - 0.14, 0.0, a4_z), (a5_x, 0.0, a4_z), 0.1, 0.1, axis='y', aside=0.105, width=0.05),
        ],
        body('hand', 'link_5', _ANTHRACITE): [
            hub((a5_x, 0.0, a4_z), 'y', 0.105, 0.15),
            tube((a5_x + 0.02, 0.0, a4_z), (flange_x - 0.05, 0.0, a4_z), 0.098, 0.09),
        ],
        body('flange', 'link_6', _STEEL): [
            tube((flange_x - 0.05, 0.0, a4_z), (flange_x - 0.012, 0.0, a4_z), 0.07, 0.07, chamfer=0.004),
            tube((flange_x - 0.012, 0.0, a4_z), (flange_x, 0.0, a4_z), 0.075, 0.075, chamfer=0.003),
        ],
    }
    return enlarged(parts, bulk)

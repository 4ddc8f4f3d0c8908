"""The families of arms with a closed form: a spherical wrist, or three parallel axes and two that meet."""

from typing import Any

import numpy as np

from robots_core.robot_model.analytic.arm_record import arm_record, set_wrist
from robots_core.robot_model.analytic.axis_lines import AxisLines


def spherical_wrist(lines: AxisLines) -> tuple[Any, float]:
    """The parameters of an arm whose axes 2 and 3 are parallel and whose axes 4, 5 and 6 meet in one point.

    KUKA, Staubli, Mitsubishi, Manutec and most others with six axes. Axis 1 may pass axis 2 at any distance
    and the forearm may be offset to any side; the angles between axes 1 and 2, 3 and 4, 4 and 5, 5 and 6 may
    be other than right; signs and zero positions are free.

    Returns:
        A record array (1,) of `ARM` without limits; how far the axes are off this structure, rad or m.

    Raises:
        NoAnalyticInverseKinematicsError: the robot is none of these; says why.
    """
    centre, off_point = lines.common_point(4, 5, 6)
    parallel, signs, off_parallel = lines.common_direction(2, 3)
    deviation = max(off_point, off_parallel)
    record, body, forearm = arm_record(
        lines, parallel, centre, signs, deviation, swung=centre, reason='the wrist centre lies on axis 3'
    )
    # The wrist is seen from the forearm, whose X axis points from axis 3 across to the wrist centre.
    cosine, sine = forearm / np.hypot(*forearm)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    set_wrist(record, lines, lines.directions[3], turn @ body)
    return record, deviation


def ur_arm(lines: AxisLines) -> tuple[Any, float]:
    """The parameters of an arm whose axes 2, 3 and 4 are parallel and whose axes 5 and 6 meet in one point.

    Arms of the Universal Robots kind. Lengths, offsets, signs and zero positions are free, and the angles
    between axes 1 and 2, 4 and 5, 5 and 6 may be other than right.

    Returns:
        A record array (1,) of `ARM` without limits; how far the axes are off this structure, rad or m.

    Raises:
        NoAnalyticInverseKinematicsError: the robot is none of these; says why.
    """
    parallel, signs, off_parallel = lines.common_direction(2, 3, 4)
    centre, off_point = lines.common_point(5, 6)
    deviation = max(off_point, off_parallel)
    record, body, _ = arm_record(
        lines,
        parallel,
        centre,
        signs,
        deviation,
        swung=lines.points[3],
        reason='axes 3 and 4 are the same line',
    )
    record[0]['parallel'] = True
    record[0]['hand'] = (body @ (centre - lines.points[3]))[:2]
    set_wrist(record, lines, parallel, body)
    return record, deviation

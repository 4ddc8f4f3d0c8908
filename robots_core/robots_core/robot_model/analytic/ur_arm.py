"""Arms of the Universal Robots kind: three parallel axes, then two that meet."""

from typing import Any

from robots_core.robot_model.analytic.arm_record import arm_record, set_forearm, set_wrist
from robots_core.robot_model.analytic.axis_lines import AxisLines


def ur_arm(lines: AxisLines) -> tuple[Any, float]:
    """The numbers of an arm whose axes 2, 3 and 4 are parallel and whose axes 5 and 6 meet in one point.

    Lengths, offsets, signs and zero positions are free, and the angles between axes 1 and 2, 4 and 5,
    5 and 6 may be other than right.

    Returns:
        A record array (1,) of `ARM` without limits; how far the axes are off this structure, rad or m.

    Raises:
        NoAnalyticInverseKinematicsError: the robot is none of these; says why.
    """
    parallel, signs, off_parallel = lines.common_direction(2, 3, 4)
    centre, off_point = lines.common_point(5, 6)
    deviation = max(off_point, off_parallel)
    record, body = arm_record(lines, parallel, centre, signs, deviation)
    forearm = (body @ (lines.points[3] - lines.points[2]))[:2]
    set_forearm(record, lines, forearm, 'axes 3 and 4 are the same line')
    record[0]['parallel'] = True
    record[0]['hand'] = (body @ (centre - lines.points[3]))[:2]
    set_wrist(record, lines, parallel, body)
    return record, deviation

"""The parameters of one arm as a record for compiled code, by the family of arms that has a closed form."""

from typing import Any

import numpy as np

from robots_core.robot_model.analytic.axis_lines import SHORTEST_LINK, AxisLines, no_closed_form
from robots_core.validation import ROTATION_TOLERANCE, Array

# A pose this far out of reach still has a solution, the nearest one: rounding of poses on the boundary is
# some 1e-16 and that of printed angles some 1e-11; solutions stay accurate to 1e-9.
REACH_SLACK = 1e-10
SLACK_PER_DEVIATION = 10.0

# Vectors in brackets are in the frame of body 1 at q = 0: X = b, Y = Z x b, Z along axis 2, where b is across
# axes 1 and 2. Axes 2 and 3 turn about Z.
ARM = np.dtype(
    [
        ('parallel', '?'),  # axis 4 is parallel to 2 and 3; otherwise the wrist is spherical
        ('origin', 'f8', (3,)),  # a point on axis 1, base frame, m
        ('basis', 'f8', (3, 3)),  # rows a (axis 2 without its part along axis 1), b, axis 1; base frame
        ('tilt_cos', 'f8'),  # Z = tilt_cos a + tilt_sin axis 1
        ('tilt_sin', 'f8'),
        ('offset', 'f8'),  # of the wrist point along Z from the origin, m
        ('wrist_point', 'f8', (3,)),  # from tool0, tool frame, m
        ('last_axis', 'f8', (3,)),  # axis 6, tool frame
        ('mark', 'f8', (3,)),  # axis 5 at q = 0 without its part along axis 6, unit, tool frame
        ('shoulder', 'f8', (2,)),  # axis 2, [X Y], m
        ('upper_arm', 'f8'),  # distance of axes 2 and 3, m
        ('upper_arm_angle', 'f8'),  # its direction at q = 0 in [X Y], rad
        ('forearm', 'f8'),  # axis 3 to what it swings (wrist centre or axis 4), m
        ('forearm_angle', 'f8'),
        ('hand', 'f8', (2,)),  # parallel axes: axis 4 to the wrist point at q = 0, [X Y], m
        ('sign_3', 'f8'),  # axis 3 along Z or against it
        ('sign_4', 'f8'),  # parallel axes: axis 4 likewise
        ('wrist_basis', 'f8', (3, 3)),  # rows: axis 5 without its part along the third, second, the third
        ('cos_a', 'f8'),  # angle between the wrist's first axis and axis 5
        ('sin_a', 'f8'),
        ('cos_b', 'f8'),  # angle between axes 5 and 6
        ('sin_b', 'f8'),
        ('straight', 'f8'),  # q5 + straight is the bend of the wrist, rad
        ('slack', 'f8'),  # m, rad
        ('rotation_tolerance', 'f8'),
        ('lower', 'f8', (6,)),
        ('upper', 'f8', (6,)),
    ]
)


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
    record, body, forearm = _arm_record(
        lines, parallel, centre, signs, deviation, swung=centre, reason='the wrist centre lies on axis 3'
    )
    # The wrist is seen from the forearm, whose X axis points from axis 3 across to the wrist centre.
    cosine, sine = forearm / np.hypot(*forearm)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    _set_wrist(record, lines, lines.directions[3], turn @ body)
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
    record, body, _ = _arm_record(
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
    _set_wrist(record, lines, parallel, body)
    return record, deviation


def _arm_record(
    lines: AxisLines,
    parallel: Array,
    wrist_point: Array,
    signs: Array,
    deviation: float,
    *,
    swung: Array,
    reason: str,
) -> tuple[Any, Array, Array]:
    """The parameters common to both families of arms: axis 1, parallel axes 2 and 3, wrist point, tool.

    `parallel` is the direction of axis 2, `signs` are those of axes 2, 3 (and 4) along it. The forearm leads
    from axis 3 to the point `swung`; without a length of it there is no closed form, for a `reason`.

    Returns:
        A record array (1,) of `ARM` without wrist and limits; the rows X, Y, Z of body 1, (3, 3); the
        forearm, (2,) m in [X Y].
    """
    record = np.zeros(1, dtype=ARM)
    arm: Any = record[0]
    lines.sine_between(1, 2)
    first = lines.directions[0]
    a = parallel - (parallel @ first) * first
    a /= np.linalg.norm(a)
    b = np.cross(first, a)
    body = np.array([b, np.cross(parallel, b), parallel])
    arm['origin'] = lines.points[0]
    arm['basis'] = [a, b, first]
    arm['tilt_cos'], arm['tilt_sin'] = parallel @ a, parallel @ first
    arm['offset'] = parallel @ (wrist_point - lines.points[0])
    arm['wrist_point'] = lines.T.T @ (wrist_point - lines.r)
    arm['shoulder'] = (body @ (lines.points[1] - lines.points[0]))[:2]
    upper_arm = (body @ (lines.points[2] - lines.points[1]))[:2]
    arm['upper_arm'], arm['upper_arm_angle'] = _polar(lines, upper_arm, 'axes 2 and 3 are the same line')
    arm['sign_3'] = signs[1]
    arm['sign_4'] = signs[2] if len(signs) > 2 else 1.0
    arm['rotation_tolerance'] = ROTATION_TOLERANCE
    arm['slack'] = max(REACH_SLACK, SLACK_PER_DEVIATION * deviation)
    forearm = (body @ (swung - lines.points[2]))[:2]
    arm['forearm'], arm['forearm_angle'] = _polar(lines, forearm, reason)
    return record, body, forearm


def _set_wrist(record: Any, lines: AxisLines, first: Array, frame: Array) -> None:
    """Enter the wrist, whose axes are `first`, (3,), 5 and 6, seen from a frame with rows `frame`, (3, 3)."""
    arm = record[0]
    fifth, sixth = lines.directions[4], lines.directions[5]
    lines.sine_between(4, 5)
    lines.sine_between(5, 6)
    across = fifth - (fifth @ first) * first
    arm['cos_a'], arm['sin_a'] = fifth @ first, np.linalg.norm(across)
    across /= np.linalg.norm(across)
    arm['wrist_basis'] = np.array([across, np.cross(first, across), first]) @ frame.T
    mark = fifth - (fifth @ sixth) * sixth
    arm['cos_b'], arm['sin_b'] = fifth @ sixth, np.linalg.norm(mark)
    arm['mark'] = lines.T.T @ (mark / np.linalg.norm(mark))
    arm['last_axis'] = lines.T.T @ sixth
    toward = first - (first @ fifth) * fifth
    arm['straight'] = np.arctan2(sixth @ np.cross(fifth, toward), sixth @ toward)


def _polar(lines: AxisLines, vector: Array, reason: str) -> tuple[float, float]:
    length = float(np.hypot(*vector))
    if length < SHORTEST_LINK:
        raise no_closed_form(lines.name, reason)
    return length, float(np.arctan2(vector[1], vector[0]))

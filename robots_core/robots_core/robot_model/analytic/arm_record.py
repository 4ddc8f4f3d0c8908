"""The parameters of one arm as a record for compiled code."""

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


def arm_record(
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

    Args:
        lines: The axes.
        parallel: Direction of axis 2, unit, (3,).
        wrist_point: The point that axis 6 (and 5) carries, (3,) m.
        signs: Of axes 2, 3 (and 4) along `parallel`.
        deviation: Largest deviation of the axes from the ideal structure, rad or m.
        swung: The point or axis that axis 3 swings by the forearm, (3,) m.
        reason: Why there is no closed form if that lies on axis 3.

    Returns:
        A record array (1,) of `ARM` without wrist and limits; the rows X, Y, Z of body 1, (3, 3); the
        forearm, (2,) m in [X Y].

    Raises:
        NoAnalyticInverseKinematicsError: axes 1 and 2 are parallel, or there is no upper arm or forearm.
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


def set_wrist(record: Any, lines: AxisLines, first: Array, frame: Array) -> None:
    """Enter the wrist: three axes, of which the first is `first`, then 5 and 6.

    Args:
        record: Changed.
        lines: The axes.
        first: Direction of the wrist's first axis at q = 0, (3,).
        frame: Rows of the frame in which the wrist's axes are expressed, (3, 3).

    Raises:
        NoAnalyticInverseKinematicsError: two of them are parallel.
    """
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

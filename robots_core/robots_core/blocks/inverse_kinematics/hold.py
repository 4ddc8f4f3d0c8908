"""Hold: what of a pose a Cartesian motion holds, for arms that cannot hold all of it too."""

from typing import Final

import numpy as np

from robots_core.blocks.direct_kinematics import DirectKinematics
from robots_core.blocks.inverse_kinematics.ik_result import IkResult
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, one_of

POSE: Final = 'pose'
DIRECTIONS: Final = 'directions'
POSITION: Final = 'position'
HOLDS: Final = (POSE, DIRECTIONS, POSITION)
"""All of the pose; the position, and of the orientation what the arm can; the position alone."""

AXES_OF_A_POSE: Final = 6
AXES_OF_A_POSITION: Final = 3
SMALLEST: Final = 1e-6  # ratio of singular values, rad per rad (m)


def check_hold(hold: str, name: str = 'hold') -> str:
    """Pass on what a motion may hold; '' for what the arm can.

    Raises:
        InvalidInputError: anything else.
    """
    return one_of(name, ('', *HOLDS))(hold)


def held_by(num_axes: int, hold: str = '') -> str:
    """What an arm holds if `hold` is wanted of it; by default as much as its axes can.

    The orientation closest to the commanded one is the commanded one where the arm can have it, so that from
    six axes on 'directions' is 'pose'; an arm of three axes has no direction left.

    Args:
        num_axes: n.
        hold: One of `HOLDS`, or '' for the default.

    Raises:
        InvalidInputError: `hold` is none of them.
    """
    check_hold(hold)
    wanted = hold or DIRECTIONS
    if wanted == DIRECTIONS and num_axes >= AXES_OF_A_POSE:
        return POSE
    if wanted == DIRECTIONS and num_axes <= AXES_OF_A_POSITION:
        return POSITION
    return wanted


def condition_rows(hold: str, num_axes: int) -> int:
    """Number of conditions in compiled code: 3 of the position, and n of the closest orientation."""
    return 3 if hold == POSITION else 3 + num_axes


def describe_miss(miss: IkResult, hold: str) -> str:
    """'20 mm and 0.03 rad', or '20 mm' where no orientation is held."""
    error = miss.position_error
    distance = f'{error:.4g} m' if error >= 1.0 else f'{error * 1e3:.3g} mm'
    return distance if hold != POSE else f'{distance} and {miss.orientation_error:.3g} rad'


def weights_of(hold: str) -> tuple[float, float]:
    """Weights of position (per m) and orientation (per rad) for inverse kinematics that minimise both."""
    return {POSE: (1.0, 0.5), DIRECTIONS: (1.0, 0.01), POSITION: (1.0, 0.0)}[hold]


def turns_in_place(robot: BaseRobotModel, q: Array, tool: Pose | None = None) -> Array:
    """Directions, as columns (3, k) in the base frame, about which an arm at `q` can turn a tool in place."""
    J = DirectKinematics(robot, tool=tool).jacobian(q)
    _, values, rows = np.linalg.svd(J[:3])
    turning = J[3:] @ rows[int((values > SMALLEST * values[0]).sum()) :].T
    if not turning.size:
        return np.empty((3, 0))
    U, values, _ = np.linalg.svd(turning)
    directions: Array = U[:, : len(values)][:, values > SMALLEST]
    return directions


def held_angle(robot: BaseRobotModel, q: Array, tool: Pose, target: Pose, hold: str) -> float:
    """Angle of a tool at `q` (n,) to its target, rad, in the directions that are held."""
    if hold == POSITION:
        return 0.0
    turn = DirectKinematics(robot, tool=tool).forward(q).error_to(target)[3:]
    if hold == DIRECTIONS:
        turn = turns_in_place(robot, q, tool).T @ turn
    return float(np.linalg.norm(turn))


def missing_directions(robot: BaseRobotModel, q: Array, hold: str) -> str:
    """What an arm of fewer than six axes cannot hold of a pose at `q`, and what helps; '' for others."""
    if robot.num_axes >= AXES_OF_A_POSE or hold != POSE:
        return ''
    able = turns_in_place(robot, q)
    missing = np.linalg.svd(able)[0].T[able.shape[1] :] if able.size else np.eye(3)
    if not len(missing):
        return ''
    about = ' or '.join(f'({", ".join(f"{value:.2f}" for value in axis + 0.0)})' for axis in missing)
    return (
        f'. {robot.name} has {robot.num_axes} axes: in place it cannot turn its tool about '
        f"{'any axis' if len(missing) == 3 else about} of the base frame; hold 'directions' or 'position' "
        "instead of 'pose'"
    )

"""What a walk says of a motion: torques past their limits, singular postures, the way around obstacles."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from robots_controller.degrees import for_program, joints_text, pose_to_program
from robots_controller.simulation.simulation_run import SimulatedMotion
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.inverse_kinematics.hold import POSITION, held_by
from robots_core.errors import RobotsError, UnreachablePoseError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.stretched_length import stretched_length
from robots_planning.pathplanning import PathPlanning, PlannedMotion
from robots_planning.verification.trajectory_verification import RATIO_TOLERANCE, verify

# Smallest over largest singular value of the Jacobian, lengths in reaches of the robot: the joints move a
# hundred times as fast in one direction as in another.
SINGULAR: Final = 0.01
SAMPLE_PERIOD: Final = 0.01  # s


def motion_problems(robot: BaseRobotModel, motion: PlannedMotion, hold: str) -> Iterator[str]:
    """What is wrong with a planned motion that holds `hold` of its poses, a sentence each."""
    use = verify(motion.trajectory, robot).uses['torque']
    if use.ratio > 1.0 + RATIO_TOLERANCE:
        yield f'limit: {use.describe()}'
    if motion.kind is not None and motion.kind.cartesian:
        yield from _singular_passage(robot, motion, held_by(robot.num_axes, hold))


def refusal(error: RobotsError, target: Pose | None, convention: str) -> str:
    """Why a motion to a pose, or to joint positions (None), was refused, with the kind of the problem."""
    angles = () if target is None else pose_to_program(target.r, target.angles(convention))[3:]
    reason = for_program(error, pose_angles=angles)
    return f'unreachable: {reason}' if isinstance(error, UnreachablePoseError) else reason


def _singular_passage(robot: BaseRobotModel, motion: PlannedMotion, hold: str) -> Iterator[str]:
    count = max(2, int(np.ceil(motion.duration / SAMPLE_PERIOD)) + 1)
    times = np.linspace(0.0, motion.duration, count)
    length = stretched_length(robot)
    scale = np.array([1.0 / length] * 3 + [1.0] * 3)[:, None]
    held = 3 if hold == POSITION else 6
    values = [
        np.linalg.svd((robot.jacobian(q) * scale)[:held], compute_uv=False)
        for q in motion.trajectory.sample(times)[0]
    ]
    ratios = np.array([found[-1] / found[0] for found in values])
    worst = int(np.argmin(ratios))
    if ratios[worst] < SINGULAR:
        part = 100.0 * times[worst] / motion.duration
        factor = 1.0 / max(ratios[worst], 1e-9)
        yield (
            f'singular: the tool passes a singular posture after {part:.0f} % of its path '
            f'({times[worst]:.2f} s): singular values differ by a factor of {factor:.3g}'
        )


def planned_path(planning: PathPlanning, motion: SimulatedMotion) -> str:
    """The path of a motion that was planned, and the smallest distance on it, for a person."""
    assert motion.plan is not None
    trajectory, command = motion.plan.trajectory, motion.command
    start, end = motion.start_on_plan, motion.end_on_plan
    text = f'{command.function}: '
    if motion.plan.via is None:
        text += 'blended into its chain'
    elif len(motion.plan.via):
        prismatic = planning.robot.axes_data.prismatic
        text += f'goes around via {", ".join(joints_text(q, prismatic) for q in motion.plan.via)}'
    else:
        text += 'takes the straight line of the axes'
    text += f', {end - start:.2f} s'
    if planning.collision is not None:
        inside = trajectory.time[(trajectory.time > start) & (trajectory.time < end)]
        times = np.concatenate([[start], inside, [end]])
        closest = planning.collision.closest_approach(JointPath(times, *trajectory.sample(times)))
        if closest is not None:
            text += f'; smallest distance: {closest.proximity.describe()} after {closest.time - start:.2f} s'
    return text

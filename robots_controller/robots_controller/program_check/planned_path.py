"""planned_path: where a motion that goes around obstacles will lead the robot, before anything moves."""

import numpy as np

from robots_controller.degrees import joints_text
from robots_controller.simulation.simulation_run import SimulatedMotion
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_planning.pathplanning import PathPlanning


def planned_path(planning: PathPlanning, motion: SimulatedMotion) -> str:
    """The path of a motion that was planned, and the smallest distance on it, for a person.

    Args:
        planning: Of the robot, with what is around it.
        motion: The motion, with its plan.
    """
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

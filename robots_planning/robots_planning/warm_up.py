"""Compile at build time what blocks and planners compile on first use: python -m robots_planning.warm_up."""

import argparse

import numpy as np

from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import HeldInverseKinematics
from robots_core.blocks.inverse_kinematics.hold import POSITION
from robots_core.kernels.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_core.warm_up import (
    CELL_JOBS,
    STEP,
    compile_in_parallel,
    drives_and_zones,
    robot_in_use,
)
from robots_planning.free_paths.free_path_search import FreePathSearch
from robots_planning.path_kinematics.path_following_kernel import stand_still, stays_inside
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.timing.tool_limits import tool_derivatives, travel
from robots_planning.trajectory_generators.collision_free_joint import CollisionFreeJoint
from robots_planning.trajectory_generators.curves_cartesian import SplineCartesian
from robots_planning.trajectory_generators.linear_cartesian import (
    LinearCartesianDynamicProgramming,
    LinearCartesianLimited,
)
from robots_planning.trajectory_generators.linear_joint import LinearJoint, LinearJointAxes


def _start() -> Array:
    """In the middle of the ranges or of a turn, off the straight arm and the straight wrist."""
    robot = robot_in_use()
    axes = robot.axes_data
    low, high = np.maximum(axes.lower, -np.pi), np.minimum(axes.upper, np.pi)
    return np.clip(robot.home + 0.05 * (high - low), axes.lower, axes.upper)


def _poses() -> tuple[Pose, Pose]:
    """At the start, and near it."""
    pose = Pose(*robot_in_use().direct_kinematics(_start()))
    return pose, Pose(pose.r + STEP, pose.T)


def joint_motions() -> None:
    """From rest and out of motions."""
    robot, start = robot_in_use(), _start()
    for joint_planner in (LinearJoint, LinearJointAxes):
        joint_planner(robot).generate(start, robot.home)
        slow = STEP * robot.axes_data.velocity
        joint_planner(robot).generate_moving((start, slow, 0.0 * slow), robot.home)


def joint_motions_around_obstacles() -> None:
    """With a free path, and with one that has to be searched for."""
    robot, start = robot_in_use(), _start()
    collision = CollisionDetection(robot)
    CollisionFreeJoint(robot, collision=collision).generate(start, robot.home)
    FreePathSearch(collision, margin=0.0, budget=0.01).path_around(start, robot.home[None])


def lines_at_limited_speed() -> None:
    """Without and with limits of the jerk, and the tool's speeds along chains of motions."""
    robot, start = robot_in_use(), _start()
    for jerk_limited in (False, True):
        LinearCartesianLimited(robot, jerk_limited=jerk_limited).generate(start, _poses()[1])
    rows = start[None]
    travel(*tool_derivatives(SerialChain.of(robot).arrays, np.zeros((1, 3)), rows, rows, rows))


def paths_at_the_limits_of_the_axes() -> None:
    """Lines and splines, and the departure from singularities."""
    robot, start, (pose, near) = robot_in_use(), _start(), _poses()
    LinearCartesianDynamicProgramming(robot).generate(start, near)
    line = CartesianLine(pose, near)
    limits = np.array([robot.axes_data.lower, robot.axes_data.upper])
    ends, still = start[None], np.empty(1, dtype=np.bool_)
    stand_still(SerialChain.of(robot).arrays, limits, line.arrays, 0.0, start, ends, still)
    stays_inside(limits, PathInverseKinematics(robot).follow(line, start).samples)
    SplineCartesian(robot, planner='dynamic_programming').generate(start, [near, pose])


def paths_that_hold_a_position() -> None:
    """Of arms that hold less than a pose; what is compiled does not depend on the number of axes."""
    robot, start, (pose, near) = robot_in_use(), _start(), _poses()
    LinearCartesianLimited(robot, hold=POSITION).generate(start, near)
    HeldInverseKinematics(robot, hold=POSITION).solve(pose, start)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--cell', action='store_true', help='only what every cell uses')
    shared, *others = CELL_JOBS
    jobs = [shared, joint_motions, lines_at_limited_speed, joint_motions_around_obstacles, *others]
    if not parser.parse_args().cell:
        jobs += [paths_that_hold_a_position, paths_at_the_limits_of_the_axes, drives_and_zones]
    compile_in_parallel(jobs)

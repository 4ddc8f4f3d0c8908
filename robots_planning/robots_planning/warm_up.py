"""Compile what is compiled on first use, once, at build time: `python -m robots_planning.warm_up`."""

import numpy as np

from robots_core.blocks.inverse_kinematics.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_planning.path_kinematics.path_following_kernel import stand_still, stays_inside
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.trajectory_generators.linear_cartesian_dynamic_programming import (
    LinearCartesianDynamicProgramming,
)
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited
from robots_planning.trajectory_generators.linear_joint import LinearJoint
from robots_planning.trajectory_generators.linear_joint_axes import LinearJointAxes
from robots_planning.trajectory_generators.spline_cartesian import SplineCartesian

STEP = 0.01  # m


def main() -> None:
    """Use every compiled planner once; the machine code stays beside the source."""
    robot = load_robot_model(available_robot_models()[0])
    axes = robot.axes_data
    # In the middle of the ranges or of a turn, off the straight arm and the straight wrist.
    low, high = np.maximum(axes.lower, -np.pi), np.minimum(axes.upper, np.pi)
    start = np.clip(robot.home + 0.05 * (high - low), axes.lower, axes.upper)
    pose = Pose(*robot.direct_kinematics(start))
    near = Pose(pose.r + STEP, pose.T)
    for joint_planner in (LinearJoint, LinearJointAxes):
        joint_planner(robot).generate(start, robot.home)
        joint_planner(robot).generate(start, robot.home, q_dot_start=STEP * axes.velocity)
    LinearCartesianLimited(robot).generate(start, near)
    LinearCartesianLimited(robot, jerk_limited=True).generate(start, near)
    LinearCartesianDynamicProgramming(robot).generate(start, near)
    # Used out of singularities only.
    line, limits = CartesianLine(pose, near), np.array([axes.lower, axes.upper])
    ends, still = start[None], np.empty(1, dtype=np.bool_)
    stand_still(SerialChain.of(robot).arrays, limits, line.arrays, 0.0, start, ends, still)
    stays_inside(limits, PathInverseKinematics(robot).follow(line, start).samples)
    SplineCartesian(robot, planner='dynamic_programming').generate(start, [near, pose])


if __name__ == '__main__':
    main()

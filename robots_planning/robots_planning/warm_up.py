"""Compile at build time what blocks and planners compile on first use: python -m robots_planning.warm_up."""

import argparse
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib import import_module
from multiprocessing import get_context

import numpy as np

from robots_core import BaseRobotModel, Pose, available_robot_models, load_robot_model
from robots_core.blocks import (
    CollisionDetection,
    ConstrainedInverseKinematics,
    DampedLeastSquares,
    FunctionDynamics,
    JointPath,
    NumericalDynamics,
    PlacedBox,
    RigidBodyDrive,
    Scene,
    SceneObject,
    SecondOrderDrive,
    Zone,
    ZoneDetection,
)
from robots_core.blocks.following.axis_following import AxisFollowing
from robots_core.blocks.inverse_kinematics.held_inverse_kinematics import HeldInverseKinematics
from robots_core.blocks.inverse_kinematics.hold import POSITION
from robots_core.kernels.serial_chain import SerialChain
from robots_core.robot_model.shapes import Box, Sphere
from robots_core.validation import Array
from robots_planning.free_paths.free_path_search import FreePathSearch
from robots_planning.path_kinematics.path_following_kernel import stand_still, stays_inside
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths.cartesian_line import CartesianLine
from robots_planning.paths.cartesian_path_kernel import travel
from robots_planning.timing.path_speed_cap import PathSpeedCap
from robots_planning.timing.tool_limits import tool_derivatives
from robots_planning.trajectory_generators.collision_free_joint import CollisionFreeJoint
from robots_planning.trajectory_generators.curves_cartesian import SplineCartesian
from robots_planning.trajectory_generators.linear_cartesian import (
    LinearCartesianDynamicProgramming,
    LinearCartesianLimited,
)
from robots_planning.trajectory_generators.linear_joint import LinearJoint, LinearJointAxes

PERIOD = 0.004  # s
STEP = 0.01  # rad (m)


def _robot() -> BaseRobotModel:
    """Any robot: all run the same machine code."""
    return load_robot_model(available_robot_models()[0])


def _start() -> Array:
    """In the middle of the ranges or of a turn, off the straight arm and the straight wrist."""
    robot = _robot()
    axes = robot.axes_data
    low, high = np.maximum(axes.lower, -np.pi), np.minimum(axes.upper, np.pi)
    return np.clip(robot.home + 0.05 * (high - low), axes.lower, axes.upper)


def _poses() -> tuple[Pose, Pose]:
    """At the start, and near it."""
    pose = Pose(*_robot().direct_kinematics(_start()))
    return pose, Pose(pose.r + STEP, pose.T)


def _compile_in_parallel(jobs: Sequence[Callable[[], None]]) -> None:
    """Run jobs that use compiled functions, in as many processes as processors, and show which have ended.

    Jobs begin in their order: the first compiles what others share, the second shares little with it. The
    machine code is kept on disk.
    """
    print(
        f'Compiling {len(jobs)} groups of functions, about a minute on two processors '
        'without what was compiled before ...',
        flush=True,
    )
    start = time.monotonic()
    with ProcessPoolExecutor(mp_context=get_context('spawn')) as pool:
        running = {pool.submit(job): job.__name__.replace('_', ' ') for job in jobs}
        for number, done in enumerate(as_completed(running), 1):
            done.result()
            seconds = time.monotonic() - start
            print(f'  {number} of {len(jobs)}: {running[done]} ({seconds:.0f} s)', flush=True)


def numerical_inverse_kinematics() -> None:
    """Iterations for one pose and for many."""
    robot = _robot()
    pose = Pose(*robot.direct_kinematics(robot.home))
    DampedLeastSquares(robot).solve(pose, robot.home)
    DampedLeastSquares(robot).solve_many(pose.r[None], pose.T[None], robot.home)


def kinematics_and_dynamics() -> None:
    """Serial chains and rigid bodies."""
    robot = _robot()
    home = robot.home
    SerialChain.of(robot).forward(home)
    robot.tool_poses(home[None])
    FunctionDynamics(robot).accelerations(home, home, home)
    NumericalDynamics(robot).accelerations(home, home, home)


def constrained_inverse_kinematics() -> None:
    """The step of the inverse kinematics inside limits."""
    robot = _robot()
    pose = Pose(*robot.direct_kinematics(robot.home))
    ConstrainedInverseKinematics(robot, PERIOD).step(pose, robot.home, 0.0 * robot.home)


def following_and_collision_checks() -> None:
    """Axes that follow, and distances."""
    robot = _robot()
    home = robot.home
    AxisFollowing(robot.axes_data, PERIOD).step(home, 0.0 * home, home, 0.0 * home, 1.0)
    collision = CollisionDetection(robot, scene=Scene((SceneObject('ball', Sphere(0.1), Pose.identity()),)))
    collision.distance(home)
    collision.distances(home, STEP)
    path = JointPath.straight(home, home + STEP)
    collision.first_approach(path)
    collision.closest_approach(path)


def drives_and_zones() -> None:
    """Drives of the higher levels, and passages through zones."""
    robot = _robot()
    home = robot.home
    RigidBodyDrive(robot, home, period=PERIOD)
    SecondOrderDrive(home, period=PERIOD).follow(np.array([[home] * 3]), np.empty((1, 2, home.size)))
    path = JointPath.straight(home, home + STEP)
    region = PlacedBox(Box((0.1, 0.1, 0.1)), Pose(np.full(3, 9.0), np.eye(3)))
    zones = (Zone('in', region, 'in', 'tool'), Zone('out', region, 'out', 'tool'))
    detection = ZoneDetection(robot, Scene(zones=zones))
    for zone in zones:
        detection.passages(zone, path)


def analytic_inverse_kinematics() -> None:
    """All closed forms, compiled with their signatures."""
    import_module('robots_core.robot_model.analytic.analytic_kernel')


def joint_motions() -> None:
    """From rest and out of motions, and the speeds at which they can be followed."""
    robot, start = _robot(), _start()
    for joint_planner in (LinearJoint, LinearJointAxes):
        trajectory = joint_planner(robot).generate(start, robot.home)
        PathSpeedCap.of(trajectory, robot.axes_data.acceleration, PERIOD)
        slow = STEP * robot.axes_data.velocity
        joint_planner(robot).generate_moving((start, slow, 0.0 * slow), robot.home)


def joint_motions_around_obstacles() -> None:
    """With a free path, and with one that has to be searched for."""
    robot, start = _robot(), _start()
    collision = CollisionDetection(robot)
    CollisionFreeJoint(robot, collision=collision).generate(start, robot.home)
    FreePathSearch(collision, margin=0.0, budget=0.01).path_around(start, robot.home[None])


def lines_at_limited_speed() -> None:
    """Without and with limits of the jerk, and the tool's speeds along chains of motions."""
    robot, start = _robot(), _start()
    for jerk_limited in (False, True):
        LinearCartesianLimited(robot, jerk_limited=jerk_limited).generate(start, _poses()[1])
    rows = start[None]
    travel(*tool_derivatives(SerialChain.of(robot).arrays, np.zeros((1, 3)), rows, rows, rows))


def paths_at_the_limits_of_the_axes() -> None:
    """Lines and splines, and the departure from singularities."""
    robot, start, (pose, near) = _robot(), _start(), _poses()
    LinearCartesianDynamicProgramming(robot).generate(start, near)
    line = CartesianLine(pose, near)
    limits = np.array([robot.axes_data.lower, robot.axes_data.upper])
    ends, still = start[None], np.empty(1, dtype=np.bool_)
    stand_still(SerialChain.of(robot).arrays, limits, line.arrays, 0.0, start, ends, still)
    stays_inside(limits, PathInverseKinematics(robot).follow(line, start).samples)
    SplineCartesian(robot, keeps_torque=True).generate(start, [near, pose])


def paths_that_hold_a_position() -> None:
    """Of arms that hold less than a pose; what is compiled does not depend on the number of axes."""
    robot, start, (pose, near) = _robot(), _start(), _poses()
    LinearCartesianLimited(robot, hold=POSITION).generate(start, near)
    HeldInverseKinematics(robot, hold=POSITION).solve(pose, start)


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--cell', action='store_true', help='only what every cell uses')
    chosen = [
        kinematics_and_dynamics,
        joint_motions,
        lines_at_limited_speed,
        joint_motions_around_obstacles,
        constrained_inverse_kinematics,
        analytic_inverse_kinematics,
        numerical_inverse_kinematics,
        following_and_collision_checks,
    ]
    if not parser.parse_args().cell:
        chosen += [paths_that_hold_a_position, paths_at_the_limits_of_the_axes, drives_and_zones]
    _compile_in_parallel(chosen)

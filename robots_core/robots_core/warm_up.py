"""What blocks compile on first use, as jobs for `python -m robots_planning.warm_up` at build time."""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from importlib import import_module
from multiprocessing import get_context

import numpy as np

from robots_core.pose import Pose
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel

PERIOD = 0.004  # s
STEP = 0.01  # rad (m)


def robot_in_use() -> BaseRobotModel:
    """Any robot: all run the same machine code."""
    return load_robot_model(available_robot_models()[0])


def compile_in_parallel(jobs: Sequence[Callable[[], None]]) -> None:
    """Run jobs that use compiled functions, in as many processes as processors, and show which have ended.

    Jobs begin in their order: the first compiles what others share, the second shares little with it. The
    machine code is kept on disk.
    """
    print(f'Compiling {len(jobs)} groups of functions, about a minute on two processors ...', flush=True)
    start = time.monotonic()
    with ProcessPoolExecutor(mp_context=get_context('spawn')) as pool:
        running = {pool.submit(job): job.__name__.replace('_', ' ') for job in jobs}
        for number, done in enumerate(as_completed(running), 1):
            done.result()
            seconds = time.monotonic() - start
            print(f'  {number} of {len(jobs)}: {running[done]} ({seconds:.0f} s)', flush=True)


def numerical_inverse_kinematics() -> None:
    """Iterations for one pose and for many."""
    from robots_core.blocks import DampedLeastSquares  # noqa: PLC0415

    robot = robot_in_use()
    pose = Pose(*robot.direct_kinematics(robot.home))
    DampedLeastSquares(robot).solve(pose, robot.home)
    DampedLeastSquares(robot).solve_many(pose.r[None], pose.T[None], robot.home)


def kinematics_and_dynamics() -> None:
    """Serial chains and rigid bodies."""
    from robots_core.blocks import FunctionDynamics, NumericalDynamics  # noqa: PLC0415
    from robots_core.kernels.serial_chain import SerialChain  # noqa: PLC0415

    robot = robot_in_use()
    home = robot.home
    SerialChain.of(robot).forward(home)
    robot.tool_poses(home[None])
    FunctionDynamics(robot).accelerations(home, home, home)
    NumericalDynamics(robot).accelerations(home, home, home)


def constrained_inverse_kinematics() -> None:
    """The step of the inverse kinematics inside limits."""
    from robots_core.blocks import ConstrainedInverseKinematics  # noqa: PLC0415

    robot = robot_in_use()
    pose = Pose(*robot.direct_kinematics(robot.home))
    ConstrainedInverseKinematics(robot, PERIOD).step(pose, robot.home, 0.0 * robot.home)


def following_and_collision_checks() -> None:
    """Axes that follow, and distances."""
    from robots_core.blocks.collision.along_paths.joint_path import JointPath  # noqa: PLC0415
    from robots_core.blocks.collision.scene import Scene, SceneObject  # noqa: PLC0415
    from robots_core.blocks.collision_detection import CollisionDetection  # noqa: PLC0415
    from robots_core.blocks.following.axis_following import AxisFollowing  # noqa: PLC0415
    from robots_core.robot_model.shapes import Sphere  # noqa: PLC0415

    robot = robot_in_use()
    home = robot.home
    AxisFollowing(robot.axes_data, PERIOD).step(home, 0.0 * home, home, 0.0 * home, 1.0)
    collision = CollisionDetection(robot, scene=Scene((SceneObject('ball', Sphere(0.1), Pose.identity()),)))
    collision.distance(home)
    path = JointPath.straight(home, home + STEP)
    collision.first_approach(path)
    collision.closest_approach(path)


def drives_and_zones() -> None:
    """Drives of the higher levels, and passages through zones."""
    from robots_core.blocks import RigidBodyDrive  # noqa: PLC0415
    from robots_core.blocks.collision.along_paths.joint_path import JointPath  # noqa: PLC0415
    from robots_core.blocks.collision.scene import Scene  # noqa: PLC0415
    from robots_core.blocks.drives.drive_train import SecondOrderDrive  # noqa: PLC0415
    from robots_core.blocks.zones.zone import PlacedBox, Zone  # noqa: PLC0415
    from robots_core.blocks.zones.zone_detection import ZoneDetection  # noqa: PLC0415
    from robots_core.robot_model.shapes import Box  # noqa: PLC0415

    robot = robot_in_use()
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


# Of every cell.
CELL_JOBS = (
    kinematics_and_dynamics,
    constrained_inverse_kinematics,
    analytic_inverse_kinematics,
    numerical_inverse_kinematics,
    following_and_collision_checks,
)

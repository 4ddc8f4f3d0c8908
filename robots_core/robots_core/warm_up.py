"""Compile what is compiled on first use, once, at build time: `python -m robots_core.warm_up`."""

from importlib import import_module

from robots_core.blocks import (
    ConstrainedInverseKinematics,
    DampedLeastSquares,
    FunctionDynamics,
    NumericalDynamics,
    RigidBodyDrive,
)
from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.collision.scene import Scene, SceneObject
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.blocks.following.axis_following import AxisFollowing
from robots_core.blocks.inverse_kinematics.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_core.robot_model.shapes import Sphere

PERIOD = 0.004  # s
WAY = 0.01  # rad (m)


def main() -> None:
    """Use every compiled block once; the machine code stays beside the source."""
    import_module('robots_core.robot_model.analytic.kernels')
    robot = load_robot_model(available_robot_models()[0])
    home = robot.home
    pose = Pose(*robot.direct_kinematics(home))
    robot.rigid_dynamics(home, home, home)
    DampedLeastSquares(robot).solve(pose, home)
    DampedLeastSquares(robot).solve_many(pose.r[None], pose.T[None], home)
    ConstrainedInverseKinematics(robot, PERIOD).step(pose, home, 0.0 * home)
    AxisFollowing(robot.axes_data, PERIOD).step(home, 0.0 * home, home, 0.0 * home, 1.0)
    SerialChain.of(robot).forward(home)
    FunctionDynamics(robot).accelerations(home, home, home)
    NumericalDynamics(robot).accelerations(home, home, home)
    RigidBodyDrive(robot, home, period=PERIOD)
    collision = CollisionDetection(robot, scene=Scene((SceneObject('ball', Sphere(0.1), Pose.identity()),)))
    collision.distance(home)
    path = JointPath.straight(home, home + WAY)
    collision.first_approach(path)
    collision.closest_approach(path)


if __name__ == '__main__':
    main()

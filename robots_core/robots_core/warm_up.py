"""Compile what is compiled on first use, once, at build time: `python -m robots_core.warm_up`."""

from importlib import import_module

from robots_core.blocks import ConstrainedInverseKinematics, DampedLeastSquares
from robots_core.pose import Pose
from robots_core.robot_choice import available_robot_models, load_robot_model

PERIOD = 0.004  # s


def main() -> None:
    """Use every compiled block once; the machine code stays beside the source."""
    import_module('robots_core.robot_model.analytic.kernels')
    robot = load_robot_model(available_robot_models()[0])
    home = robot.home
    pose = Pose(*robot.direct_kinematics(home))
    DampedLeastSquares(robot).solve(pose, home)
    ConstrainedInverseKinematics(robot, PERIOD).step(pose, home, 0.0 * home)


if __name__ == '__main__':
    main()

"""A straight line in the shortest time within torque limits, next to one that plans without them."""

import numpy as np

from robots_core import Pose, load_robot_model
from robots_planning import LinearCartesianDynamicProgramming, LinearCartesianLimited, verify


def main() -> None:
    """Plan the line with both planners, and print their durations and what limits them."""
    robot = load_robot_model('kuka_kr210_r2700')
    q = np.radians([0.0, -90.0, 90.0, 20.0, 60.0, 0.0])
    r, T = robot.direct_kinematics(q)
    target = Pose(r + np.array([0.0, 1.2, -0.3]), T)
    for planner in (
        LinearCartesianDynamicProgramming(robot),
        LinearCartesianLimited(robot, cartesian_speed=9.0),
    ):
        line = planner.generate(q, target)
        print(f'{type(planner).__name__}: {line.duration:.3f} s;', verify(line, robot).describe())


if __name__ == '__main__':
    main()

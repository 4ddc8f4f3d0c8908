"""Joint positions that bring the tool of any URDF to a pose, in closed form and numerically."""

import argparse
from pathlib import Path

import numpy as np

from robots_core import Pose, load_robot_model
from robots_core.blocks import AnalyticalInverseKinematic, DampedLeastSquares
from robots_core.errors import NoAnalyticInverseKinematicsError

UR5E = Path(__file__).parents[1] / 'robots_models' / 'robots_models' / 'ur5e' / 'robot.urdf'


def main(urdf: Path | str = UR5E) -> None:
    """Move the tool 50 mm up from a posture near home, and print the joint positions."""
    robot = load_robot_model(f'urdf:{urdf}')
    axes = robot.axes_data
    q = np.clip(np.add(robot.home, 0.2), axes.lower, axes.upper)  # rad (m)
    r, T = robot.direct_kinematics(q)
    above = Pose(r + np.array([0.0, 0.0, 0.05]), T)
    print(f'{robot.name}: {robot.num_axes} axes, {", ".join(axes.names)}')
    try:
        print('closed form: ', np.round(AnalyticalInverseKinematic(robot).solve(above, q), 4))
    except NoAnalyticInverseKinematicsError as error:
        print(f'no closed form: {error}')
    found = DampedLeastSquares(robot).solve(above, q)
    print('numerical:   ', np.round(found.q, 4), f'off by {1e3 * found.position_error:.3f} mm')


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('urdf', nargs='?', type=Path, default=UR5E, help='path of a URDF')
    main(parser.parse_args().urdf)

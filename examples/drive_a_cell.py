"""Move the robot of a live cell from Python: `make demo` in another terminal, or `cell --robot NAME`."""

import argparse

import numpy as np

from robots_controller.client import CellClient
from robots_core.pose import Pose

BACK = Pose(np.array([0.0, 0.0, -0.1]), np.eye(3))  # m, along the tool's axis


def main(namespace: str = '') -> None:
    """Move near home, then back by 100 mm on a line, and switch an output."""
    with CellClient(namespace) as cell:
        cell.change_settings(speed_fraction=0.5)
        cell.move_joint(np.add(cell.robot.home, 0.2)).wait()  # rad; many a home is at a singularity
        cell.io['digital_output.1'] = True
        for progress in cell.move_line(cell.tool_pose @ BACK, cartesian_speed=0.1).updates():
            print(f'{progress:4.0%} at {np.round(np.degrees(cell.q), 1)} deg')
        cell.io['digital_output.1'] = False


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--namespace', default='', help='namespace of the cell')
    main(parser.parse_args().namespace)

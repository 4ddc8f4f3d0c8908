"""The rigid-body drives next to the published results of the Modelica Standard Library's FullRobot.

    python test/benchmark/compare_full_robot.py FullRobot.csv

FullRobot.csv is not part of this project: it is at github.com/modelica/MAP-LIB_ReferenceResults, in
Modelica/Mechanics/MultiBody/Examples/Systems/RobotR3/FullRobot. Both move the same robot with the same drives
along the same reference; the example lets the motors' currents pass 9 A, so ours have no limit here.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
from full_robot import DURATION, LOAD, SWING_TIME, simulate
from rich.console import Console
from rich.table import Table

from robots_core.blocks import RigidBodyDrive
from robots_models.manutec_r3.model import ManutecR3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('csv', type=Path)
    parser.add_argument('--step', type=float, default=0.25e-3, help='of the integration, s')
    options = parser.parse_args()
    with options.csv.open() as file:
        heading, *rows = list(csv.reader(file))
    published = dict(zip(heading, np.array(rows, dtype=float).T, strict=True))
    robot = ManutecR3()
    drives = replace(robot.drive_data, torque_limit=np.full(6, np.inf))
    drive = RigidBodyDrive(
        robot, robot.home, period=options.step, payload=LOAD, drives=drives, longest_step=options.step
    )
    time, q, tau = simulate(drive, options.step, DURATION + SWING_TIME)
    print(f'end: ours {DURATION + SWING_TIME:.10f} s, published {published["time"][-1]:.10f} s')
    constant = robot.axes_data.gear_ratio * np.array(robot.DATA.torque_constant)
    table = Table(
        'axis', title=f'Ours less published, {time.size} instants, steps of {1e3 * options.step:g} ms'
    )
    for column in ('angle, max rad', 'rms rad', 'torque, max N m', 'rms N m', 'of max N m'):
        table.add_column(column, justify='right')
    for axis in range(6):
        angle = np.interp(time, published['time'], published[f'mechanics.r{axis + 1}.phi'])
        current = np.interp(time, published['time'], published[f'axis{axis + 1}.motor.La.i'])
        off, missing = q[:, axis] - angle, tau[:, axis] - constant[axis] * current
        table.add_row(
            f'r{axis + 1}',
            f'{np.abs(off).max():.1e}',
            f'{np.sqrt(np.mean(off**2)):.1e}',
            f'{np.abs(missing).max():.2f}',
            f'{np.sqrt(np.mean(missing**2)):.2f}',
            f'{np.abs(constant[axis] * current).max():.0f}',
        )
    Console(width=110).print(table)


if __name__ == '__main__':
    main()

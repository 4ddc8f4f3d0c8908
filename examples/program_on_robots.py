"""One robot program on several robots: cycle times, and the speeds of the tools over time as a picture."""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model
from robots_core.validation import Array

ROBOTS = ('kuka_kr210_r2700', 'kuka_kr210_r3100', 'kuka_kr500_r2830')


def main(arguments: list[str] | None = None) -> None:
    """Simulate the program on each robot, print a line for each, and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--program', type=Path, default=Path('programs/welding.lua'))
    parser.add_argument('--robots', nargs='+', default=ROBOTS)
    parser.add_argument('--picture', type=Path, default=Path('out/program_on_robots.png'))
    options = parser.parse_args(arguments)
    runs = [simulate(options.program, robot=robot, drive='ideal') for robot in options.robots]
    for run in runs:
        reason = '' if run.error is None else f': {run.error}'
        print(f'{run.robot:20} {run.duration:7.3f} s, {len(run.motions)} motions, {run.state}{reason}')
    options.picture.parent.mkdir(parents=True, exist_ok=True)
    picture(runs).savefig(options.picture)
    print(options.picture)


def tool_speed(run: SimulationRun) -> Array:
    """Speed of the flange, (k,) m/s, at the times of a run."""
    robot = load_robot_model(run.robot)
    r = np.array([robot.direct_kinematics(q)[0] for q in run.position])
    speed: Array = np.linalg.norm(np.gradient(r, run.period, axis=0), axis=1)
    return speed


def picture(runs: list[SimulationRun]) -> Figure:
    """Speeds of the tools over time."""
    figure = Figure(figsize=(8, 4), layout='constrained')
    axes = figure.subplots()
    for run in runs:
        axes.plot(run.time, tool_speed(run), label=f'{run.robot}, {run.duration:.1f} s')
    axes.set(xlabel='time, s', ylabel='speed of the flange, m/s', title=runs[0].program.name)
    axes.grid(color='#e0e4e8')
    axes.legend()
    return figure


if __name__ == '__main__':
    main()

"""A picture per planner: every axis over its limits, with position, velocity, acceleration, jerk and torque.

Run by `make plots`, which writes them to out/plots.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from drawing.figures import drawing_style
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_planning import (
    CircularCartesian,
    LinearCartesianDynamicProgramming,
    LinearCartesianLimited,
    LinearJoint,
    LinearJointAxes,
    MotionSettings,
    PathPlanning,
    SplineCartesian,
    Trajectory,
    verify,
)
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, QueuedCommand
from robots_planning.motion_kinds import LINE

STEP = 1e-3  # s
COLOURS = ('#2f6fb0', '#e08a2c', '#3d9a5f', '#b5464b', '#7b63a8', '#5b6672', '#c06c9c')
FAST = {'cartesian_speed': 2.0, 'cartesian_acceleration': 20.0}


@dataclass(frozen=True)
class Picture:
    """A motion to show.

    Attributes:
        name: Of the file.
        title: What is planned.
        trajectory: The plan.
        kept: Quantities whose limits its planner keeps; the others are shown without a verdict.
    """

    name: str
    title: str
    trajectory: Trajectory
    kept: tuple[str, ...]


ALWAYS = ('position', 'velocity', 'acceleration')


def pictures(robot: BaseRobotModel) -> list[Picture]:
    q = np.radians([-20.0, -80.0, 80.0, 20.0, 60.0, -10.0])
    goal = np.radians([50.0, -50.0, 40.0, -30.0, 30.0, 40.0])
    start = Pose(*robot.direct_kinematics(q))

    def moved(*step: float, turn: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Pose:
        return Pose(start.r + np.array(step), Pose.from_angles([0.0] * 3, turn).T @ start.T)

    end = moved(0.1, 0.8, -0.4, turn=(0.4, 0.0, 0.2))
    poses = [moved(0.1, 0.3, 0.2), moved(-0.1, 0.6, -0.2, turn=(0.3, 0.0, 0.0)), moved(0.0, 0.9, 0.0)]
    first = LinearJoint(robot).generate(q, goal)
    state = first.sample(0.45 * first.duration)
    torque, jerk = (*ALWAYS, 'torque'), (*ALWAYS, 'jerk')
    half_circle = [moved(0.0, 0.3, 0.3), moved(0.0, 0.6, 0.0)]
    return [
        Picture('linear_joint', 'LinearJoint', first, jerk),
        Picture('linear_joint_axes', 'LinearJointAxes', LinearJointAxes(robot).generate(q, goal), jerk),
        Picture(
            'linear_joint_from_motion',
            'LinearJoint, a new target while the robot moves',
            LinearJoint(robot).generate_moving((state[0], state[1], state[2]), q),
            jerk,
        ),
        Picture(
            'linear_cartesian_limited',
            'LinearCartesianLimited',
            LinearCartesianLimited(robot, **FAST).generate(q, end),
            ALWAYS,
        ),
        Picture(
            'linear_cartesian_jerk_limited',
            'LinearCartesianLimited with jerk limits',
            LinearCartesianLimited(robot, jerk_limited=True, **FAST).generate(q, end),
            jerk,
        ),
        Picture(
            'linear_cartesian_dynamic_programming',
            'LinearCartesianDynamicProgramming',
            LinearCartesianDynamicProgramming(robot).generate(q, end),
            torque,
        ),
        Picture(
            'circular_cartesian',
            'CircularCartesian, half a circle',
            CircularCartesian(robot, keeps_torque=True, **FAST).generate(q, half_circle),
            torque,
        ),
        Picture(
            'spline_cartesian',
            'SplineCartesian through three poses',
            SplineCartesian(robot, keeps_torque=True, **FAST).generate(q, poses),
            torque,
        ),
        Picture('blended_chain', 'Three lines, blended within 0.1 m', chain(robot, q, poses), torque),
    ]


def chain(robot: BaseRobotModel, q: np.ndarray, poses: list[Pose]) -> Trajectory:
    modal = MotionSettings(blend_zone=0.1, cartesian_keeps_torque=True, **FAST)  # type: ignore[arg-type]
    orders = tuple(QueuedCommand(str(number), LINE, pose, modal, 0.0) for number, pose in enumerate(poses))
    return MotionChain(PathPlanning(robot)).plan(CommandChain(orders), q).motion.trajectory


def quantities(robot: BaseRobotModel, trajectory: Trajectory) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times (m,), and by quantity its values over their limits, (m, n)."""
    axes, model = robot.axes_data, robot.rigid_dynamics_model
    t = np.linspace(0.0, trajectory.duration, round(trajectory.duration / STEP) + 1)
    q, q_dot, q_ddot = trajectory.sample(t)
    jerk = np.gradient(q_ddot, t, axis=0)
    torque = np.array([model.torques(*row) for row in zip(q, q_dot, q_ddot, strict=True)])
    middle, half = 0.5 * (axes.lower + axes.upper), 0.5 * (axes.upper - axes.lower)
    return t, {
        'position': (q - middle) / half,
        'velocity': q_dot / axes.velocity,
        'acceleration': q_ddot / axes.acceleration,
        'jerk': jerk / axes.jerk,
        'torque': torque / axes.effort,
    }


def draw(robot: BaseRobotModel, picture: Picture) -> Figure:
    t, values = quantities(robot, picture.trajectory)
    shown = [name for name in values if name != 'jerk' or 'jerk' in picture.kept]
    figure, rows = plt.subplots(
        len(shown), 1, sharex=True, figsize=(9.0, 1.0 + 1.75 * len(shown)), layout='constrained'
    )
    for row, name in zip(rows, shown, strict=True):
        largest = max(1.2, 1.1 * float(np.abs(values[name]).max()))
        for sign in (-1.0, 1.0):
            row.axhspan(sign, sign * largest, color='#c8434a', alpha=0.10, linewidth=0.0)
            row.axhline(sign, color='#c8434a', linewidth=0.8)
        for axis, column in enumerate(values[name].T):
            row.plot(t, column, color=COLOURS[axis % len(COLOURS)], label=robot.axes_data.names[axis])
        row.set(ylim=(-largest, largest), yticks=[-1, 0, 1], ylabel=name, xlim=(0.0, t[-1]))
        row.margins(x=0.0)
        if name not in picture.kept:
            row.annotate(
                'not limited by this planner',
                (0.995, 0.12),
                xycoords='axes fraction',
                ha='right',
                va='bottom',
                fontsize=8,
                color='#606a74',
            )
    rows[-1].set_xlabel('time, s')
    report = verify(picture.trajectory, robot, torque=False, start_motion=start_motion(picture.trajectory))
    assert report.ok, report.describe()
    figure.suptitle(
        f'{picture.title}: {picture.trajectory.duration:.3f} s', x=0.02, ha='left', fontsize=13, weight='bold'
    )
    figure.legend(
        *rows[0].get_legend_handles_labels(),
        loc='outside lower center',
        ncols=robot.num_axes,
        frameon=False,
        title=f'{robot.name}; every value over its limit, shaded: beyond',
        title_fontsize=9,
    )
    return figure


def start_motion(trajectory: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    return trajectory.velocity[0], trajectory.acceleration[0]


def main(argv: list[str] | None = None, show: Callable[[str], None] = print) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--folder', type=Path, default=Path('out/plots'))
    folder = parser.parse_args(argv).folder
    folder.mkdir(parents=True, exist_ok=True)
    robot = load_robot_model('kuka_kr210_r2700')
    with drawing_style():
        for picture in pictures(robot):
            figure = draw(robot, picture)
            path = folder / f'{picture.name}.png'
            figure.savefig(path, dpi=110)
            plt.close(figure)
            show(str(path))


if __name__ == '__main__':
    main()

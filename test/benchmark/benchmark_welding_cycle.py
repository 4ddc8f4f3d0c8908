"""The welding program's motions with our planners, next to common trapezoids.

Run by `make benchmark-planning`. The trapezoids follow the published description of MoveIt's Pilz Industrial
Motion Planner (moveit.picknik.ai, "Pilz Industrial Motion Planner"): PTP moves all axes in the same phases of
acceleration, constant velocity and deceleration, under the strictest velocity and acceleration limit of all
axes; LIN has a trapezoid over the Cartesian path, translation and rotation at the same time, and refuses
where an axis would break its limit. Its user would then lower the speed; here the whole motion is slowed
down by as little as it takes. Trapezoids jump in acceleration; ours do not, and joint motions keep jerk
limits too.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from robots_controller.simulate import simulate
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_planning import MotionSettings, PathPlanning
from robots_planning.motion_kinds import LINE
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.paths.cartesian_line import CartesianLine

ROBOT = 'kuka_kr210_r2700'
PROGRAM = Path(__file__).parents[2] / 'programs' / 'welding.lua'
SAMPLES = 2000  # of a trapezoid, to see what the axes do


def trapezoid_duration(way: float, velocity: float, acceleration: float) -> float:
    """s; a triangle where the way is too short to reach the velocity."""
    if way * acceleration <= velocity**2:
        return 2.0 * float(np.sqrt(way / acceleration))
    return way / velocity + velocity / acceleration


def trapezoid(way: float, velocity: float, acceleration: float) -> tuple[np.ndarray, ...]:
    """s, s_dot and s_ddot from 0 to 1 at instants in between, (SAMPLES,) each."""
    duration = trapezoid_duration(way, velocity, acceleration)
    t = (np.arange(SAMPLES) + 0.5) * duration / SAMPLES
    ramp = min(velocity / acceleration, 0.5 * duration)
    a = 1.0 / (ramp * (duration - ramp))
    early, late = t < ramp, t > duration - ramp
    s = np.where(early, 0.5 * a * t**2, 0.5 * a * ramp**2 + a * ramp * (t - ramp))
    s = np.where(late, 1.0 - 0.5 * a * (duration - t) ** 2, s)
    s_dot = a * np.where(early, t, np.where(late, duration - t, ramp))
    return s, s_dot, a * (early.astype(float) - late)


def joint_trapezoid(robot: BaseRobotModel, start: np.ndarray, end: np.ndarray) -> float:
    axes = robot.axes_data
    longest = float(np.abs(end - start).max())
    return trapezoid_duration(longest, float(axes.velocity.min()), float(axes.acceleration.min()))


def line_trapezoid(robot: BaseRobotModel, start: np.ndarray, target: Pose, modal: MotionSettings) -> float:
    """Duration, slowed down until the axes keep their limits."""
    kinematics, axes = PathInverseKinematics(robot), robot.axes_data
    line = CartesianLine(kinematics.pose(start), target)
    path = kinematics.follow(line, start)
    # The slower of translation and rotation leads, as their profiles have the same phases.
    profiles = [
        (line.length, modal.cartesian_speed, modal.cartesian_acceleration),
        (line.angle, modal.rotation_speed, modal.rotation_acceleration),
    ]
    leading = max(profiles, key=lambda profile: trapezoid_duration(*profile))
    s, s_dot, s_ddot = trapezoid(*leading)
    _, q_s, q_ss = path.evaluate(s)
    q_dot = q_s * s_dot[:, None]
    q_ddot = q_ss * (s_dot**2)[:, None] + q_s * s_ddot[:, None]
    # Velocity falls with the factor of time, acceleration with its square.
    slower = max(
        float((np.abs(q_dot) / axes.velocity).max()),
        float(np.sqrt((np.abs(q_ddot) / axes.acceleration).max())),
        1.0,
    )
    return slower * trapezoid_duration(*leading)


def main() -> None:
    robot = load_robot_model(ROBOT)
    planning = PathPlanning(robot)
    run = simulate(PROGRAM, robot=ROBOT)
    optimal = MotionSettings(cartesian_planner='dynamic_programming')
    rows = []
    for motion in run.motions:
        command = motion.command
        assert motion.plan is not None
        start, end = motion.plan.trajectory.position[[0, -1]]
        if command.kind is LINE:
            assert command.pose is not None
            target: Pose | np.ndarray = command.pose
            common = line_trapezoid(robot, start, command.pose, motion.settings)
        else:
            assert command.q is not None
            target, common = command.q, joint_trapezoid(robot, start, end)
        best = planning.plan(command.kind, start, target, optimal)
        rows.append((command.line, command.function, motion.plan.duration, best.duration, common))
    table = Table(title=f'{PROGRAM.name} on {ROBOT}, motions from rest to rest, s')
    for column in ('line', 'function'):
        table.add_column(column)
    for column in ('as it is', 'dynamic programming', 'common trapezoid', 'trapezoid / as it is'):
        table.add_column(column, justify='right')
    for number, function, *durations in rows:
        cells = [f'{value:.3f}' for value in durations]
        table.add_row(str(number), function, *cells, f'{durations[2] / durations[0]:.2f}')
    totals = np.array([row[2:] for row in rows]).sum(axis=0)
    table.add_section()
    table.add_row('', 'all motions', *(f'{value:.3f}' for value in totals), f'{totals[2] / totals[0]:.2f}')
    Console(width=130).print(table)


if __name__ == '__main__':
    main()

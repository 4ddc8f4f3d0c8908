"""Draw what the person in the cabin feels, the limits and the tracking; run by `make plots-motion-simulator`.

The program is simulated, unless `--run BAG` names a recorded run of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from drawing.figures import COLOURS, drawing_style, plot_parser, recorded, save, title_and_legend
from motion_simulator.cabin import ENVELOPE, ROBOT
from motion_simulator.recorded_cabin import RecordedCabin, read_cabin
from robots_controller.simulate import simulate
from robots_core.blocks import Payload, VehicleMotion
from robots_core.blocks.motion_cueing.cabin_envelope import DIRECTIONS
from robots_core.blocks.motion_cueing.vehicle_motion import GRAVITY
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.validation import Array

PROGRAMS: Final = Path(__file__).parents[1]
PROGRAM: Final = PROGRAMS / 'motion_simulator.lua'
REFERENCES: Final = PROGRAMS / 'motion_simulator' / 'double_lane_change'
CABIN: Final = Payload(300.0, np.array([0.0, 0.0, 0.7]))  # as in the program
WANTED, ASKED, FELT = '#9aa3ad', '#e08a2c', '#2f6fb0'
LIMIT: Final = '#c8434a'


def felt_figure(cabin: RecordedCabin) -> Figure:
    """Specific force and angular velocity: wanted, by the cueing, and by the drives of the robot."""
    groups = [
        ([step.wanted for step in cabin.steps], cabin.time, WANTED, 'wanted: the scaled motion of the car'),
        (
            [step.felt for step in cabin.steps],
            cabin.time,
            ASKED,
            'felt if the robot followed the cueing exactly',
        ),
        (cabin.felt(), cabin.drive_time, FELT, 'felt on the robot'),
    ]
    figure, rows = plt.subplots(3, 2, sharex=True, figsize=(11.0, 7.5), layout='constrained')
    for motions, time, colour, label in groups:
        force, rate = _columns(motions)
        for index in range(3):
            rows[index, 0].plot(time, force[:, index], color=colour, label=label)
            rows[index, 1].plot(time, rate[:, index], color=colour)
    for index, name in enumerate(('forward', 'left', 'up, without g')):
        rows[index, 0].set_ylabel(f'{name}, m/s²')
    for index, name in enumerate(('roll', 'pitch', 'yaw')):
        rows[index, 1].set_ylabel(f'{name}, rad/s')
    rows[0, 0].set_title('specific force', loc='left')
    rows[0, 1].set_title('angular velocity', loc='left')
    _finish(figure, rows, f'What the person feels in the cabin of {ROBOT}', ncols=3)
    return figure


def _columns(motions: Sequence[VehicleMotion]) -> tuple[Array, Array]:
    force = np.array([motion.specific_force for motion in motions]) - np.array([0.0, 0.0, GRAVITY])
    return force, np.array([motion.angular_velocity for motion in motions])


def limits_figure(cabin: RecordedCabin) -> Figure:
    """Every axis of the robot over its limits."""
    axes = cabin.robot.axes_data
    loaded = LoadedRobot(cabin.robot, CABIN)
    q, q_dot, q_ddot = cabin.reference
    torque = np.array([loaded.rigid_dynamics(*row)[0] for row in zip(q, q_dot, q_ddot, strict=True)])
    middle, half = 0.5 * (axes.lower + axes.upper), 0.5 * (axes.upper - axes.lower)
    shown = {
        'position': (q - middle) / half,
        'velocity': q_dot / axes.velocity,
        'acceleration': q_ddot / axes.acceleration,
        'torque with\nthe cabin': torque / axes.effort,
    }
    figure, rows = plt.subplots(len(shown), 1, sharex=True, figsize=(11.0, 8.0), layout='constrained')
    for row, (name, values) in zip(rows, shown.items(), strict=True):
        for axis, column in enumerate(values.T):
            row.plot(cabin.reference_time, column, color=COLOURS[axis], label=axes.names[axis])
        for sign in (-1.0, 1.0):
            row.axhspan(sign, 1.2 * sign, color=LIMIT, alpha=0.10, linewidth=0.0)
            row.axhline(sign, color=LIMIT, linewidth=0.8)
        row.set(ylim=(-1.2, 1.2), yticks=[-1, 0, 1], ylabel=name)
    _finish(figure, rows, f'The axes of {ROBOT} over their limits; shaded: beyond', ncols=6)
    return figure


def tracking_figure(cabin: RecordedCabin) -> Figure:
    """The cabin's place in its envelope, and how far the robot is behind."""
    figure, grid = plt.subplots(4, 2, sharex=True, figsize=(11.0, 9.0), layout='constrained')
    rows = [*grid[:3, 0], *grid[:3, 1]]
    washout, asked = (
        np.array([values[0] for values in found])
        for found in ([s.washout for s in cabin.steps], [s.cabin for s in cabin.steps])
    )
    given = cabin.cabin()
    for index, row in enumerate(rows):
        row.plot(cabin.time, washout[:, index], color=WANTED, label='washout filter')
        row.plot(cabin.time, asked[:, index], color=ASKED, label='cabin, inside its envelope')
        row.plot(cabin.drive_time, given[:, index], color=FELT, label='robot')
        bound = ENVELOPE.reach[index]
        for sign in (-1.0, 1.0):
            row.axhspan(sign * bound, sign * 1.15 * bound, color=LIMIT, alpha=0.10, linewidth=0.0)
        row.set(
            ylim=(-1.15 * bound, 1.15 * bound), ylabel=f'{DIRECTIONS[index]}, {"m" if index < 3 else "rad"}'
        )
    position, angle = cabin.tracking()
    for row, values, unit in ((grid[3, 0], position, 'mm'), (grid[3, 1], angle, 'mrad')):
        row.plot(cabin.drive_time, 1e3 * values, color=COLOURS[3])
        row.set(ylabel=f'robot to cueing, {unit}', ylim=(0.0, None))
    _finish(figure, grid, f'The cabin of {ROBOT} in its envelope; shaded: beyond', ncols=3)
    return figure


def _finish(figure: Figure, rows: Any, title: str, *, ncols: int) -> None:
    for row in np.atleast_2d(rows)[-1] if np.ndim(rows) == 2 else [rows[-1]]:
        row.set_xlabel('time, s')
        row.margins(x=0.0)
    title_and_legend(figure, rows, title, ncols=ncols)


def describe(cabin: RecordedCabin) -> list[str]:
    """The figures in words."""
    axes, loaded = cabin.robot.axes_data, LoadedRobot(cabin.robot, CABIN)
    q, q_dot, q_ddot = cabin.reference
    torque = np.array([loaded.rigid_dynamics(*row)[0] for row in zip(q, q_dot, q_ddot, strict=True)])
    used = (
        ('velocity', np.abs(q_dot) / axes.velocity),
        ('acceleration', np.abs(q_ddot) / axes.acceleration),
        ('torque with the cabin', np.abs(torque) / axes.effort),
    )
    lines = [f'largest {name}: {100.0 * part.max():.0f} % of its limit' for name, part in used]
    position, angle = cabin.tracking()
    lines.append(
        f'robot to cueing: at most {1e3 * position.max():.1f} mm and {1e3 * angle.max():.1f} mrad, '
        f'rms {1e3 * np.sqrt((position**2).mean()):.2f} mm and {1e3 * np.sqrt((angle**2).mean()):.2f} mrad'
    )
    felt, _ = _columns(cabin.felt())
    wanted, _ = _columns([step.wanted for step in cabin.steps])
    for index, name in enumerate(('forward', 'left')):
        there = np.interp(cabin.drive_time, cabin.time, wanted[:, index])
        error = np.sqrt(((felt[:, index] - there) ** 2).mean())
        alike = np.corrcoef(felt[:, index], there)[0, 1]
        lines.append(
            f'force {name}: wanted rms {np.sqrt((there**2).mean()):.3f} m/s^2, felt differs by rms '
            f'{error:.3f}, correlation {alike:.2f}'
        )
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = plot_parser('motion_simulator', __doc__)
    parser.add_argument(
        '--references', type=Path, default=REFERENCES, metavar='BAG', help='what guided the robot'
    )
    options = parser.parse_args(arguments)
    guided = options.references
    run = recorded(options, lambda bag: simulate(PROGRAM, robot=ROBOT, references=guided, bag=bag))
    cabin = read_cabin(run, guided)
    with drawing_style():
        figures = {'felt': felt_figure, 'limits': limits_figure, 'tracking': tracking_figure}
        save(((name, draw(cabin)) for name, draw in figures.items()), options.folder)
    print('\n'.join(describe(cabin)))


if __name__ == '__main__':
    main()

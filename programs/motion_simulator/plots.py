"""Draw what the person in the cabin feels, the limits and the tracking; run by `make plots-motion-simulator`.

The program is simulated, unless `--run BAG` names a recorded run of it; the same for the program of the robot
on a linear axis, and `--run-on-axis BAG`.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from drawing.figures import COLOURS, drawing_style, plot_parser, recorded, save, title_and_legend
from motion_simulator.recorded_cabin import RecordedCabin, read_recorded_cabin
from robots_controller.program.files.program_header import read_program_header
from robots_controller.simulate import simulate
from robots_core.blocks import Payload, VehicleMotion
from robots_core.blocks.motion_cueing.cabin_envelope import DIRECTIONS
from robots_core.blocks.motion_cueing.vehicle_motion import GRAVITY
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.validation import Array

PROGRAMS: Final = Path(__file__).parents[1]
PROGRAM: Final = PROGRAMS / 'motion_simulator.lua'
ON_AXIS: Final = PROGRAMS / 'motion_simulator' / 'on_linear_axis.lua'
CABIN: Final = Payload(300.0, np.array([0.0, 0.0, 0.7]))  # as in the program
WANTED, ASKED, FELT, WITH_AXIS = '#9aa3ad', '#e08a2c', '#2f6fb0', '#3d9a5f'
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
    _finish(figure, rows, f'What the person feels in the cabin of {cabin.robot.name}', ncols=3)
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
    _finish(figure, rows, f'The axes of {cabin.robot.name} over their limits; shaded: beyond', ncols=7)
    return figure


def tracking_figure(cabin: RecordedCabin) -> Figure:
    """The cabin's place in its envelope, and how far the robot is behind."""
    figure, grid = plt.subplots(4, 2, sharex=True, figsize=(11.0, 9.0), layout='constrained')
    rows = [*grid[:3, 0], *grid[:3, 1]]
    washout, asked = (
        np.array([values[0] for values in found])
        for found in ([s.washout for s in cabin.steps], [s.cabin for s in cabin.steps])
    )
    given = cabin.ways()
    for index, row in enumerate(rows):
        row.plot(cabin.time, washout[:, index], color=WANTED, label='washout filter')
        row.plot(cabin.time, asked[:, index], color=ASKED, label='cabin, inside its envelope')
        row.plot(cabin.drive_time, given[:, index], color=FELT, label='robot')
        bound = cabin.cabin.envelope.reach[index]
        for sign in (-1.0, 1.0):
            row.axhspan(sign * bound, sign * 1.15 * bound, color=LIMIT, alpha=0.10, linewidth=0.0)
        row.set(
            ylim=(-1.15 * bound, 1.15 * bound), ylabel=f'{DIRECTIONS[index]}, {"m" if index < 3 else "rad"}'
        )
    position, angle = cabin.tracking()
    for row, values, unit in ((grid[3, 0], position, 'mm'), (grid[3, 1], angle, 'mrad')):
        row.plot(cabin.drive_time, 1e3 * values, color=COLOURS[3])
        row.set(ylabel=f'robot to cueing, {unit}', ylim=(0.0, None))
    _finish(figure, grid, f'The cabin of {cabin.robot.name} in its envelope; shaded: beyond', ncols=3)
    return figure


def axis_figure(standing: RecordedCabin, sliding: RecordedCabin) -> Figure:
    """Force forward and surge of the same drive, with and without the linear axis."""
    figure, rows = plt.subplots(4, 1, sharex=True, figsize=(11.0, 9.0), layout='constrained')
    wanted, _ = _columns([step.wanted for step in standing.steps])
    rows[0].plot(standing.time, wanted[:, 0], color=WANTED, label='wanted: the scaled motion of the car')
    for cabin, colour, label in (
        (standing, FELT, 'felt on the robot that stands'),
        (sliding, WITH_AXIS, 'felt on the linear axis'),
    ):
        felt, _ = _columns(cabin.felt())
        there = np.interp(cabin.drive_time, standing.time, wanted[:, 0])
        ways = cabin.ways()
        rows[0].plot(cabin.drive_time, felt[:, 0], color=colour, label=label)
        rows[1].plot(cabin.drive_time, felt[:, 0] - there, color=colour)
        rows[2].plot(cabin.drive_time, ways[:, 0], color=colour)
        rows[3].plot(cabin.drive_time, ways[:, 4], color=colour)
    first = sliding.drives[0, :, 0]
    rows[2].plot(sliding.drive_time, first - first[0], color=WITH_AXIS, linestyle='--', label='of it by E1')
    rows[2].legend(frameon=False)
    for row, name in zip(
        rows, ('forward, m/s²', 'felt - wanted, m/s²', 'surge, m', 'pitch, rad'), strict=True
    ):
        row.set_ylabel(name)
    _finish(figure, rows, 'Force forward, with and without a linear axis', ncols=3)
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
        '--run-on-axis', type=Path, metavar='BAG', help='recorded run on the axis; simulated by default'
    )
    options = parser.parse_args(arguments)
    standing = _recorded(PROGRAM, options.run, options.folder)
    sliding = _recorded(ON_AXIS, options.run_on_axis, options.folder / 'on_axis')
    with drawing_style():
        figures = {'felt': felt_figure, 'limits': limits_figure, 'tracking': tracking_figure}
        save(((name, draw(standing)) for name, draw in figures.items()), options.folder)
        save(
            (('with_axis', axis_figure(standing, sliding)), ('limits_on_axis', limits_figure(sliding))),
            options.folder,
        )
    for cabin in (standing, sliding):
        print('\n'.join([cabin.robot.name, *describe(cabin)]))


def _recorded(program: Path, run: Path | None, folder: Path) -> RecordedCabin:
    header = read_program_header(program)
    options = Namespace(run=run, folder=folder)
    robot, cabin = header.robot, header.cabin
    bag = recorded(
        options,
        lambda to: simulate(program, robot=robot, cabin=cabin, references=header.references, bag=to),
    )
    return read_recorded_cabin(bag, robot=robot, cabin=cabin)


if __name__ == '__main__':
    main()

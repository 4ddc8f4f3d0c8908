"""Draw what the wheel laboratory measures; run by `make plots-wheel-laboratory`.

The program is simulated, unless `--run BAG` names a recorded run of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from drawing.figures import drawing_style, plot_parser, recorded, save, title_and_legend
from robots_controller.cell.contact_setup import ContactSetup, read_contact
from robots_controller.simulate import simulate
from robots_core.blocks import WheelSoilModel
from wheel_laboratory.published import LOAD, MEASURED, SOIL, WHEEL
from wheel_laboratory.recorded_wheel import ROBOT, WheelRun, read_runs

PROGRAMS: Final = Path(__file__).parents[1]
PROGRAM: Final = PROGRAMS / 'wheel_laboratory.lua'
CONTACT: Final = PROGRAMS / 'wheel_laboratory' / 'regolith_simulant.yaml'
SENSOR, MODEL, WANTED = '#e08a2c', '#2f6fb0', '#9aa3ad'
COLOURS: Final = ('#2f6fb0', '#3d9a5f', '#8aa13a', '#e0b02c', '#e08a2c', '#c8434a', '#7b63a8', '#5b6672')
STRESS_SLIPS: Final = (0.1, 0.4, 0.8)


def slip_figure(runs: Sequence[WheelRun], setup: ContactSetup) -> Figure:
    """Drawbar pull, torque and sinkage over slip: measured on the robot, and by the model at the load."""
    model, load = setup.contact().model, runs[0].wanted
    slips = np.linspace(0.0, max(run.slip for run in runs), 81)
    sinkages = [model.sinkage(load, slip) for slip in slips]
    forces = [model.forces(*row) for row in zip(sinkages, slips, strict=True)]
    shown = (
        ('drawbar_pull', 1.0, 'drawbar pull, N', [one.drawbar_pull for one in forces]),
        ('torque', 1.0, 'torque, N m', [one.torque for one in forces]),
        ('sinkage', 1e3, 'sinkage, mm', [1e3 * one for one in sinkages]),
    )
    figure, rows = plt.subplots(1, 3, figsize=(11.0, 4.2), layout='constrained')
    for row, (name, scale, label, curve) in zip(rows, shown, strict=True):
        row.plot(slips, curve, color=MODEL, label=f'Wong-Reece model at {load:g} N')
        means = [scale * run.steady(name).mean() for run in runs]
        spread = [scale * np.ptp(run.steady(name)) / 2.0 for run in runs]
        row.errorbar(
            [run.slip for run in runs],
            means,
            spread,
            fmt='o',
            color=SENSOR,
            capsize=3,
            label='measured by the force/torque sensor, steady part',
        )
        row.set(xlabel='slip', ylabel=label, xlim=(-0.03, slips[-1] + 0.03))
    ratio = rows[0].secondary_yaxis('right', functions=(lambda y: y / load, lambda y: y * load))
    ratio.set_ylabel('over the load')
    rows[2].set_ylim(0.0, 1.15e3 * max(sinkages))
    wheel = setup.wheel
    title_and_legend(figure, rows, f'A wheel of {wheel.radius:g} x {wheel.width:g} m over its slip', ncols=2)
    return figure


def published_figure() -> Figure:
    """A published single-wheel test, and the model with parameters that were identified from it."""
    model, slips = WheelSoilModel(WHEEL, SOIL), np.linspace(0.0, 0.6, 61)
    sinkages = [model.sinkage(LOAD, slip) for slip in slips]
    forces = [model.forces(*row) for row in zip(sinkages, slips, strict=True)]
    curves = (
        ('drawbar pull, N', [one.drawbar_pull for one in forces]),
        ('torque, N m', [one.torque for one in forces]),
        ('sinkage, mm', [1e3 * one for one in sinkages]),
    )
    slip, *measured = np.array(MEASURED).T
    figure, rows = plt.subplots(1, 3, figsize=(11.0, 4.2), layout='constrained')
    for row, (label, curve), points in zip(rows, curves, measured, strict=True):
        row.plot(slips, curve, color=MODEL, label='Wong-Reece model, parameters identified here')
        row.plot(slip, points, 's', color=COLOURS[1], label='measured, Ding et al. 2011')
        row.set(xlabel='slip', ylabel=label)
    rows[2].set_ylim(0.0, None)
    title_and_legend(figure, rows, f'A published single-wheel test: smooth wheel at {LOAD:g} N', ncols=2)
    return figure


def time_figure(runs: Sequence[WheelRun]) -> Figure:
    """Load with its wanted value, sinkage and drawbar pull of all runs over time."""
    figure, rows = plt.subplots(3, 1, sharex=True, figsize=(11.0, 8.0), layout='constrained')
    for run, colour in zip(runs, COLOURS, strict=False):
        label = f'slip {100.0 * run.slip:.0f} %'
        rows[0].plot(run.time, run.load, color=colour, label=label)
        rows[1].plot(run.time, 1e3 * run.sinkage, color=colour)
        rows[2].plot(run.time, run.drawbar_pull, color=colour)
    rows[0].axhline(runs[0].wanted, color=WANTED, linestyle='--', label='wanted')
    for row, label in zip(rows, ('load, N', 'sinkage, mm', 'drawbar pull, N'), strict=True):
        row.set_ylabel(label)
        row.axvline(runs[0].driving, color=WANTED, linewidth=0.8)
    rows[0].set_title('pressing, then driving from the vertical line on', loc='left', fontsize=10)
    rows[-1].set_xlabel('time, s')
    title_and_legend(figure, rows, f'Force control of {ROBOT}', ncols=4)
    return figure


def stress_figure(runs: Sequence[WheelRun], setup: ContactSetup) -> Figure:
    """Normal and shear stress below the wheel, by the model at the load."""
    model, load = setup.contact().model, runs[0].wanted
    figure, row = plt.subplots(figsize=(8.0, 4.6), layout='constrained')
    for slip, colour in zip(STRESS_SLIPS, COLOURS[::2], strict=False):
        sinkage = model.sinkage(load, slip)
        entry, _, leave = model.angles(sinkage, slip)
        theta = np.linspace(leave, entry, 200)
        normal, shear = model.stresses(theta, sinkage, slip)
        row.plot(np.degrees(theta), 1e-3 * normal, color=colour, label=f'normal, slip {slip:g}')
        row.plot(np.degrees(theta), 1e-3 * shear, color=colour, linestyle='--', label=f'shear, slip {slip:g}')
    row.set(xlabel='angle from straight below the hub, forward, degrees', ylabel='stress, kPa')
    title_and_legend(figure, [row], f'Stress below the wheel at {load:g} N', ncols=3)
    return figure


def describe(runs: Sequence[WheelRun]) -> list[str]:
    """The figures in words, a line for each run."""
    lines = [' slip   load, N   drawbar pull, N   torque, N m   sinkage, mm   wheel, rad/s']
    for run in runs:
        load, pull, torque, sinkage, wheel = (
            float(run.steady(name).mean())
            for name in ('load', 'drawbar_pull', 'torque', 'sinkage', 'wheel_speed')
        )
        lines.append(
            f'{run.slip:5.2f} {load:9.2f} {pull:17.2f} {torque:13.3f} {1e3 * sinkage:13.2f} {wheel:14.3f}'
        )
    return lines


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = plot_parser('wheel_laboratory', __doc__)
    parser.add_argument('--contact', type=Path, default=CONTACT, metavar='FILE', help='wheel and soil')
    options = parser.parse_args(arguments)
    contact = options.contact
    run = recorded(options, lambda bag: simulate(PROGRAM, robot=ROBOT, contact=contact, bag=bag))
    setup = read_contact(contact)
    runs = read_runs(run, setup)
    with drawing_style():
        figures = {
            'slip': slip_figure(runs, setup),
            'time': time_figure(runs),
            'stress': stress_figure(runs, setup),
            'published': published_figure(),
        }
        save(figures.items(), options.folder)
    print('\n'.join(describe(runs)))


if __name__ == '__main__':
    main()

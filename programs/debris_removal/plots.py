"""Draw attitude and momentum of chaser and target; run by `make plots-debris-removal`.

The program is simulated, unless `--run BAG` names a recorded run of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from debris_removal.recorded_bodies import AT_REST, HELD, ROBOT, RecordedBodies, describe, read_bodies
from drawing.figures import COLOURS, drawing_style, plot_parser, recorded, save, title_and_legend
from robots_controller.simulate import simulate
from robots_core import Pose
from robots_core.blocks.floating_base.orbit import read_orbit
from robots_core.blocks.floating_base.rendezvous import PARTS
from robots_core.orientation import rotation_vector
from robots_core.validation import Array

PROGRAM: Final = Path(__file__).parents[1] / 'debris_removal.lua'
ORBIT: Final = Path(__file__).parent / 'orbit.yaml'
CHASER, TARGET, WHEELS = COLOURS[0], COLOURS[1], COLOURS[2]
SATELLITE: Final = np.array([[-0.35, 0.0], [0.35, 0.0], [0.35, 0.9], [-0.35, 0.9]])  # m, x and z
DEBRIS: Final = np.array([[-0.9, 0.0], [-0.6, -0.3], [0.9, -0.3], [0.9, 0.3], [-0.6, 0.3]])


def attitude_figure(bodies: RecordedBodies) -> Figure:
    """How far both have turned, how fast they turn, and how far the gripper is from the ring."""
    figure, rows = plt.subplots(3, 1, sharex=True, figsize=(11.0, 8.0), layout='constrained')
    ring = read_orbit(ORBIT).target.ring
    for poses, colour, name in ((bodies.base, CHASER, 'chaser'), (bodies.target, TARGET, 'target')):
        turned = np.unwrap(
            [rotation_vector(pose.T @ poses[0].T.T) for pose in poses], period=2.0 * np.pi, axis=0
        )
        rates = bodies.rates(poses)
        for axis, style in enumerate(('-', '--', ':')):
            label = f'{name}, {"xyz"[axis]}'
            rows[0].plot(bodies.time, np.degrees(turned[:, axis]), style, color=colour, label=label)
            rows[1].plot(bodies.time[1:], np.degrees(rates[:, axis]), style, color=colour)
    away = [np.linalg.norm(bodies.tool(k).r - (bodies.target[k] @ ring).r) for k in range(len(bodies.time))]
    rows[2].plot(bodies.time, away, color=COLOURS[4])
    for row, name in zip(
        rows, ('turned, degrees', 'angular velocity, degrees/s', 'gripper to ring, m'), strict=True
    ):
        row.set_ylabel(name)
    rows[2].set_ylim(0.0, None)
    _finish(figure, rows, bodies, 'Attitude of chaser and target, in the world', ncols=6)
    return figure


def momentum_figure(bodies: RecordedBodies) -> Figure:
    """Angular momentum of the parts, and the change of the total."""
    figure, rows = plt.subplots(4, 1, sharex=True, figsize=(11.0, 9.0), layout='constrained')
    for axis, row in enumerate(rows[:3]):
        for part, colour in enumerate((CHASER, TARGET, WHEELS)):
            row.plot(bodies.time, bodies.momentum[:, part, 3 + axis], color=colour, label=PARTS[part])
        total = bodies.momentum[:, :, 3 + axis].sum(axis=1)
        row.plot(bodies.time, total, color='#303840', linewidth=2.2, alpha=0.5, label='total')
        row.set_ylabel(f'about {"xyz"[axis]}, N m s')
    names = ('linear, 1e-15 N s', 'angular, 1e-15 N m s')
    for values, name in zip(np.split(bodies.drift, 2, axis=1), names, strict=True):
        rows[3].plot(bodies.time, 1e15 * np.linalg.norm(values, axis=1), label=name)
    rows[3].set_ylabel('change of the total')
    rows[3].legend(frameon=False, loc='upper left', ncols=2)
    _finish(figure, rows, bodies, "Angular momentum about the world's origin", ncols=4)
    return figure


def scene_figure(bodies: RecordedBodies) -> Figure:
    """The bodies from the side at the start, at the grasp and at the end."""
    held = bodies.inputs[HELD]
    grasp = len(bodies.time) // 2 if held is None else int(np.searchsorted(bodies.time, held))
    moments = ((0, 'start'), (min(grasp, len(bodies.time) - 1), 'grasp'), (-1, 'end'))
    figure, places = plt.subplots(1, 3, sharey=True, figsize=(11.0, 4.2), layout='constrained')
    for place, (k, name) in zip(places, moments, strict=True):
        base = bodies.base[k]
        frames, _ = bodies.robot.kinematic_model.frame_axes(bodies.joints[k])
        reach, _ = bodies.robot.direct_kinematics(bodies.joints[k])
        arm = np.array([base.r + base.T @ point for point in (*frames, reach)])
        place.add_patch(Polygon(_outline(base, SATELLITE), color=CHASER, alpha=0.6))
        place.add_patch(Polygon(_outline(bodies.target[k], DEBRIS), color=TARGET, alpha=0.6))
        place.plot(arm[:, 0], arm[:, 2], 'o-', color='#303840', linewidth=2.5, markersize=4)
        place.set(aspect='equal', xlim=(-1.0, 4.6), ylim=(-0.6, 3.4), xlabel='x, m')
        place.set_title(f'{name}, {bodies.time[k]:.1f} s', loc='left')
    places[0].set_ylabel('z, m')
    figure.suptitle(f'{ROBOT.partition("?")[0]} and its target from the side, in the world')
    return figure


def _outline(pose: Pose, points: Array) -> Array:
    corners = np.array([[x, 0.0, z] for x, z in points])
    return np.asarray((pose.r + corners @ pose.T.T)[:, [0, 2]])


def _finish(figure: Figure, rows: Any, bodies: RecordedBodies, title: str, *, ncols: int) -> None:
    for time, name, left in ((bodies.inputs[HELD], 'grasp', 3), (bodies.inputs[AT_REST], 'at rest', -45)):
        if time is not None:
            for row in rows:
                row.axvline(time, color='#5b6672', linewidth=0.8)
            edge = {'xycoords': ('data', 'axes fraction'), 'textcoords': 'offset points'}
            rows[0].annotate(name, (time, 1.0), (left, 3), **edge)
    rows[-1].set(xlabel='time, s', xlim=(bodies.time[0], bodies.time[-1]))
    title_and_legend(figure, rows, title, ncols=ncols)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    options = plot_parser('debris_removal', __doc__).parse_args(arguments)
    run = recorded(options, lambda bag: simulate(PROGRAM, robot=ROBOT, orbit=ORBIT, bag=bag))
    bodies = read_bodies(run)
    with drawing_style():
        figures = {'attitude': attitude_figure, 'momentum': momentum_figure, 'scene': scene_figure}
        save(((name, draw(bodies)) for name, draw in figures.items()), options.folder)
    print('\n'.join(describe(bodies)))


if __name__ == '__main__':
    main()

"""Draw the forces on arm and rover; run by `make plots-rover-placement`.

The program is simulated, unless `--run BAG` names a recorded run of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from drawing.figures import COLOURS, drawing_style, plot_parser, recorded, save
from robots_controller.simulate import simulate
from rover_mission.recorded_mission import ROBOT, RecordedMission, describe, read_mission

PROGRAMS: Final = Path(__file__).parents[1]
PROGRAM: Final = PROGRAMS / 'rover_placement.lua'
SCENE: Final = PROGRAMS / 'scenes' / 'rover_placement.yaml'
IO: Final = PROGRAMS / 'io' / 'rover_placement.yaml'


def forces_figure(mission: RecordedMission) -> Figure:
    """Torques over their limits, force and moment on the rover, mast and clearance."""
    figure, rows = plt.subplots(4, 1, sharex=True, figsize=(11.0, 9.5), layout='constrained')
    axes = mission.robot.axes_data
    for axis, column in enumerate((mission.torque / axes.effort).T):
        rows[0].plot(mission.time, column, color=[*COLOURS, '#303840'][axis], label=axes.names[axis])
    rows[0].set(ylabel='torque (force) over limit', ylim=(-1.0, 1.0))
    rows[0].legend(frameon=False, loc='upper right', ncols=len(axes.names), fontsize=8)
    rows[1].plot(mission.time, mission.ground[:, 2], color=COLOURS[0])
    rows[1].set_ylabel('ground on rover, N')
    for axis, name in enumerate(('roll', 'pitch')):
        rows[2].plot(mission.time, mission.ground[:, 3 + axis], color=COLOURS[axis], label=name)
    rows[2].set_ylabel('moment on rover, N m')
    rows[2].legend(frameon=False, loc='upper right', ncols=2)
    rows[3].plot(mission.time, 1e3 * mission.clearance, color=COLOURS[3], label='clearance, mm')
    rows[3].plot(mission.time, 1e3 * mission.position[:, 0], color=COLOURS[2], label='mast, mm')
    rows[3].set(ylabel='mm', xlabel='time, s', xlim=(mission.time[0], mission.time[-1]))
    rows[3].legend(frameon=False, loc='upper right', ncols=2)
    held = np.flatnonzero(np.diff((mission.mass > 0.0).astype(int)))
    for row in rows:
        if len(held) == 2:
            row.axvspan(*mission.time[held], color='#e08a2c', alpha=0.10, linewidth=0.0)
    figure.suptitle(f'Forces on arm and rover of {ROBOT}; shaded: with the package')
    return figure


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    options = plot_parser('rover_placement', __doc__).parse_args(arguments)
    run = recorded(options, lambda bag: simulate(PROGRAM, robot=ROBOT, scene=SCENE, io=IO, bag=bag))
    mission = read_mission(run, SCENE)
    with drawing_style():
        save([('forces', forces_figure(mission))], options.folder)
    print('\n'.join(describe(mission)))


if __name__ == '__main__':
    main()

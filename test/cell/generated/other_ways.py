"""Generated programs through real nodes, in lock-step and live: what must be as it is in their simulation."""

import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

from cell.bag_checks import changes, check_references, read_messages
from cell.both_cells import check_both_cells
from cell.lockstep_runs import LockstepRun, run_cell_with
from robots_controller.report.run_report import run_report
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model
from robots_core.validation import Array

from .program_generator import FIRST_ON_PATH, GeneratedProgram
from .run_laws import distance_to_way

DELAY: Final = 0.05  # s, that messages take to the recorder at most, on a machine with nothing else to do
PLACE_TOLERANCE: Final = 1e-3  # m


def lockstep_problems(program: GeneratedProgram, folder: Path) -> list[str]:
    """What is not to the last bit as in the simulation."""
    path, code, text, bag = _run(program, folder, '--composed', '--lockstep')
    try:
        check_both_cells(LockstepRun(Path(path), code, text, Path(bag)), 'ideal', folder / 'other_bag')
    except AssertionError:
        return [f'lock-step: {traceback.format_exc(limit=-2)}\n{text}']
    return []


def live_problems(program: GeneratedProgram, simulation: SimulationRun, folder: Path) -> list[str]:
    """What is not as in the simulation, except for the time that messages take.

    A handler that ends a motion ends it elsewhere in every live run: only limits are checked there.
    """
    _, code, text, bag = _run(program, folder)
    return [f'live: {problem}' for problem in _live_problems(program, simulation, Path(bag), code, text)]


def _live_problems(
    program: GeneratedProgram, simulation: SimulationRun, bag: Path, code: int, text: str
) -> Iterator[str]:
    messages = read_messages(bag, ['/joint_reference', '/digital_outputs'])
    try:
        check_references(messages, load_robot_model(program.robot))
    except AssertionError:
        yield traceback.format_exc(limit=-1)
    if "'abort'" in program.text:
        return
    if (code == 0) != simulation.ok or run_report(bag).ok != simulation.ok:
        yield f'exit code {code}, simulated: {simulation.state}\n{text}'
        return
    there, here = _places(program, bag), _places(program, folder_bag(simulation))
    # The last ones before a program fails may be on for less time than the recorder needs to see them.
    if there.keys() != here.keys() and (simulation.ok or not there.keys() <= here.keys()):
        yield f'outputs {sorted(there)} are switched on paths, simulated: {sorted(here)}'
        return
    for output, points in there.items():
        off = distance_to_way(here[output][-1], points)
        if off > PLACE_TOLERANCE:
            yield f'output {output} is switched {1e3 * off:.2f} mm off its place'


def folder_bag(simulation: SimulationRun) -> Path:
    """The recording of a simulation."""
    assert simulation.bag is not None
    return simulation.bag


def _run(program: GeneratedProgram, folder: Path, *options: str) -> tuple[str, int, str, str]:
    path = folder / f'generated_{program.seed}.lua'
    return run_cell_with(path, folder / ('live', *options)[-1].strip('-'), '--drive', 'ideal', *options)


def _places(program: GeneratedProgram, bag: Path) -> dict[int, Array]:
    """Where the flange has been when an output on a path was switched, (k, 3), the newest place last."""
    robot = load_robot_model(program.robot)
    messages = read_messages(bag, ['/joint_reference', '/digital_outputs'])
    times = np.array([time for time, _ in messages['/joint_reference']])
    references = [message.points[0].positions for _, message in messages['/joint_reference']]
    found = {}
    for time, output, value in changes(messages, 'digital_outputs'):
        if output >= FIRST_ON_PATH and value == 1.0:
            first, last = np.searchsorted(times, [time - DELAY, time])
            rows = references[max(int(first) - 1, 0) : int(last) + 1]
            found[output] = np.array([robot.direct_kinematics(np.asarray(q))[0] for q in rows])
    return found

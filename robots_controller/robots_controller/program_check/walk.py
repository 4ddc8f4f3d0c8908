"""walk_program: what a program meets, whatever its inputs are."""

import itertools
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Final

from robots_controller.defaults import LONGEST_WALK, MOST_COMBINATIONS
from robots_controller.io.io_image import Channel
from robots_controller.io.plc_script import PlcScript, read_plc_script
from robots_controller.program_check.lenient_planning import LenientPlanning
from robots_controller.program_check.motion_problems import motion_problems, planned_path, refusal
from robots_controller.program_check.program_check import ProgramProblem
from robots_controller.simulation.cell_parts import CellSetup, cell_parts
from robots_controller.simulation.simulated_cell import SimulatedCell
from robots_controller.study.case_runners import worker_pool
from robots_core.blocks.multibody.loaded_robot import loaded_robot

START_OF_PROCESSES: Final = 2.0  # s, what they take to load
Inputs = Mapping[Channel, float]
"""Values of all inputs that a script names, at the start; from there the script's rules set them."""


def input_combinations(script: PlcScript) -> Iterator[Inputs]:
    """Every combination of the inputs that a script sets, starts with or names; its own start comes first.

    A digital input is off or on; an analog one has any of the values that the script gives it, or 0.
    """
    inputs = [channel for channel in script.channels if channel.direction == 'input']
    for values in itertools.product(*(_values(script, channel) for channel in inputs)):
        yield dict(zip(inputs, values, strict=True))


def described(inputs: Inputs, script: PlcScript) -> str:
    """For a person: press_ready on, press_force 0."""
    names = {channel: name for name, channel in script.signals.items()}
    words = (
        f'{names.get(channel, channel.name)} '
        f'{("off", "on")[int(value)] if channel.kind == "digital" else format(value, "g")}'
        for channel, value in inputs.items()
    )
    return ', '.join(words)


def _values(script: PlcScript, channel: Channel) -> tuple[float, ...]:
    own = float(script.initial.get(channel, 0.0))
    given = {0.0, 1.0} if channel.kind == 'digital' else {0.0}
    given |= {value for rule in script.rules for one, value in rule.settings if one == channel}
    return (own, *sorted(given - {own}))


@dataclass(frozen=True)
class WalkResult:
    """What walks of a program found.

    Attributes:
        problems: By file and line; each with the combinations of inputs that lead to it.
        walked: Number of combinations that were walked.
        possible: Number of combinations that there are.
        paths: Of motions with `avoid`, by file and line, which they begin with; for a person.
    """

    problems: tuple[ProgramProblem, ...]
    walked: int
    possible: int
    paths: tuple[str, ...] = ()


def walk_program(
    setup: CellSetup,
    *,
    most: int = MOST_COMBINATIONS,
    longest: float = LONGEST_WALK,
    patience: float = math.inf,
    workers: int = 1,
) -> WalkResult:
    """Walk a program with ideal drives, once for each combination of the inputs at its start.

    A motion that is refused is reported, and the robot brought to its target anyway, so that the rest
    of the program is walked too.

    Args:
        setup: Of its cell: the inputs of the PLC's script are combined, and its rules are played.
        most: Highest number of combinations to walk, the script's own start first.
        longest: A walk ends after this simulated time, s.
        patience: All walks end after this time of the machine, s; names the line where each was.
        workers: Processes to walk in where they save time; 1 is this one.

    Raises:
        RobotsError: an unknown robot, a file that is not valid, or a program that is not Lua.
    """
    until = time.monotonic() + patience
    script = _script(setup)
    everything = list(input_combinations(script))
    combinations = everything[:most]
    walk = partial(_walk, setup, longest, patience, until)
    # What is wrong with the input itself is raised here, before processes start.
    begin = time.monotonic()
    walks, left = [walk(combinations[0])], combinations[1:]
    expected = len(left) * (time.monotonic() - begin)
    if workers > 1 and left and expected >= START_OF_PROCESSES:
        with worker_pool(workers) as pool:
            walks += pool.map(walk, left)
    else:
        walks += map(walk, left)
    problems = tuple(_together(script, combinations, [problems for problems, _ in walks]))
    paths = dict.fromkeys(path for _, paths in walks for path in paths)
    shown = tuple(f'{file}:{line}: {text}' for file, line, text in sorted(paths, key=itemgetter(0, 1)))
    return WalkResult(problems, len(combinations), len(everything), shown)


def _walk(
    setup: CellSetup, longest: float, patience: float, until: float, inputs: Inputs
) -> tuple[list[ProgramProblem], list[tuple[str, int, str]]]:
    """Problems and paths around obstacles (file, line, text) of one walk; none begins after `until`."""
    left = until - time.monotonic()
    if left <= 0.0:
        late = f'not walked within the patience of {patience:g} s'
        return [ProgramProblem(Path(setup.program).name, 0, late)], []
    parts = cell_parts(replace(setup, io=''))
    planning = LenientPlanning(parts.planning)
    cell_io = replace(parts.cell_io, script=replace(_script(setup), initial=inputs))
    # Planning reports what collides; no guard stops the robot before it. Where guides would lead is
    # unknown.
    parts = replace(parts, planning=planning, cell_io=cell_io, walked=True)
    cell = SimulatedCell(parts, drive='ideal', longest=longest, patience=left)
    run = cell.run()
    found: dict[ProgramProblem, None] = {}
    paths: list[tuple[str, int, str]] = []
    for motion in run.motions:
        if motion.plan is None:
            continue
        file, command = motion.file, motion.command
        error = planning.problems.get(motion.plan)
        reasons = (
            [refusal(error, command.pose, parts.robot.orientation_convention)]
            if error is not None
            else motion_problems(
                loaded_robot(parts.robot, motion.settings.payload), motion.plan, motion.settings.hold
            )
        )
        if error is None and motion.settings.avoid and not command.kind.cartesian:
            paths.append((file, command.line, planned_path(planning, motion)))
        for reason in reasons:
            found[ProgramProblem(file, command.line, f'{command.function}: {reason}')] = None
    if run.error is not None:
        found[ProgramProblem(run.error.file, run.error.line, run.error.reason)] = None
    return list(found), paths


def _script(setup: CellSetup) -> PlcScript:
    return read_plc_script(setup.io) if setup.io else PlcScript(())


def _together(
    script: PlcScript, combinations: Sequence[Inputs], found: Sequence[list[ProgramProblem]]
) -> Iterator[ProgramProblem]:
    """Each problem once, with the combinations that lead to it."""
    where: dict[ProgramProblem, list[Inputs]] = {}
    for inputs, problems in zip(combinations, found, strict=True):
        for problem in problems:
            where.setdefault(problem, []).append(inputs)
    for problem in sorted(where, key=lambda one: (one.file, one.line)):
        leading = where[problem]
        if len(leading) == len(combinations):
            yield problem
            continue
        share = f'with {len(leading)} of {len(combinations)} combinations of inputs'
        yield replace(problem, reason=f'{problem.reason} ({share}: {described(leading[0], script)})')

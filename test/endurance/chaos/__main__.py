"""Kill and freeze every node of a cell at random moments: make chaos COUNT=50."""

import argparse
import random
import signal
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from printed_tables import machine, show
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from ros_domains import reserved_domain

from .judgement import judge
from .kept_faults import KeptFaults, Key
from .observer import Observer
from .summary import Fault, closing_line, missed_goals, summary
from .surroundings import PROGRAMS, SURROUNDINGS, Surroundings
from .trial import NotReadyError, Trial, let_go_on, random_trial, run_trial

MOST_STARTS = 5  # of one cell in a row


def main() -> int:
    """Print each fault, the table of all, and the machine; returns 1 if a goal was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('count', type=int, help='faults of each node, killed and frozen in turn')
    parser.add_argument('--seed', type=int, default=1, help='of the moments')
    parser.add_argument(
        '--in', dest='where', action='append', choices=['cell', 'launch'], help='both by default'
    )
    parser.add_argument('--node', action='append', help='these nodes alone')
    parser.add_argument('--program', action='append', help='these programs alone: seam, handling, curves')
    parser.add_argument(
        '--keep', type=Path, help='file of the faults that were tried: a run that was interrupted continues'
    )
    parser.add_argument('--markdown', action='store_true', help='the table as Markdown')
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the cell ends with this process
    began = time.monotonic()
    before = machine()
    kept = KeptFaults(options.keep)
    try:
        for kind in SURROUNDINGS:
            if options.where is None or kind.name in options.where:
                programs = options.program or ['seam', 'handling', 'curves']
                for number, program in enumerate(programs):
                    rounds = range(number, options.count, len(programs))
                    _in_one_cell(kind, PROGRAMS / f'{program}.lua', rounds, options, kept)
    except KeyboardInterrupt:
        print('interrupted: what there is so far')
    faults = kept.faults
    if not faults:
        print('no fault was tried')
        return 1
    show(summary(faults), markdown=options.markdown)
    print(f'{closing_line(faults)}; seed {options.seed}, {(time.monotonic() - began) / 60.0:.0f} minutes')
    print(f'{before}; load {machine().partition("load ")[2].partition(",")[0]} at the end')
    return 1 if any(missed_goals(fault.figures) for fault in faults) else 0


def _in_one_cell(
    kind: type[Surroundings], program: Path, rounds: range, options: argparse.Namespace, kept: KeptFaults
) -> None:
    """Faults of all nodes in a cell, each once in a round; a cell of no use any more is restarted."""

    def key(trial: Trial) -> Key:
        return options.seed, kind.name, program.stem, trial.number, trial.node

    with tempfile.TemporaryDirectory(prefix='chaos_') as folder, reserved_domain() as environment:
        cell = kind(program, environment, Path(folder))
        nodes = [node for node in cell.nodes if options.node is None or node in options.node]
        rng = random.Random(f'{options.seed} {kind.name} {program.stem}')  # noqa: S311  # no secret
        trials = [
            random_trial(options.seed, number, node, killed=number % 2 == 0)
            for number in rounds
            for node in rng.sample(nodes, len(nodes))
        ]
        trials = [trial for trial in trials if key(trial) not in kept]
        starts = 0
        while trials and starts < MOST_STARTS:
            starts += 1
            for trial, fault in _while_usable(cell, tuple(trials), environment):
                kept.add(key(trial), fault)
                trials.remove(trial)
                starts = 0
        if trials:
            print(f'{kind.name}, {program.name}: given up after {starts} starts', flush=True)


def _while_usable(
    cell: Surroundings, trials: Sequence[Trial], environment: Mapping[str, str]
) -> Iterator[tuple[Trial, Fault]]:
    robot, domain = load_robot_model(cell.robot), int(environment['ROS_DOMAIN_ID'])
    with Observer(robot, domain, cell.nodes) as observer, cell:
        for trial in trials:
            try:
                recording = run_trial(trial, cell, observer)
            except NotReadyError as error:
                print(f'{cell.name}: {error}', flush=True)
                return
            figures = judge(recording, robot)
            if not figures.usable and not observer.hears and _usable_for_another(robot, domain):
                print(f'{cell.name}: the observer hears nothing of a cell that another one uses', flush=True)
                return  # the fault is tried again
            fault = Fault(cell.name, trial.node, trial.killed, figures)
            _tell(trial, fault, recording.reason)
            yield trial, fault
            if not figures.usable:
                return


def _usable_for_another(robot: BaseRobotModel, domain: int) -> bool:
    """Whether a fresh observer can let the robot move: the middleware of the first one may have failed."""
    with Observer(robot, domain) as another:
        return let_go_on(another, 0.0) < np.inf


def _tell(trial: Trial, fault: Fault, reason: str) -> None:
    figures = fault.figures
    how = 'killed' if trial.killed else f'frozen, then {"alive" if trial.revived else "killed"}'
    told = []
    if figures.stops:
        told.append(f'stands after {figures.stands:.3f} s (braking {figures.braking:.3f} s)')
    if not np.isnan(figures.deviation):
        told.append(f'{1e3 * figures.deviation:.2f} mm off its path')
    if not np.isnan(figures.outputs_safe):
        told.append(f'outputs safe after {figures.outputs_safe:.3f} s')
    told.append(f'usable after {figures.usable_after:.1f} s' if figures.usable else 'not usable')
    told.append(reason or 'no fault')
    print(f'{fault.surroundings} {trial.number} {trial.node} {how}: {", ".join(told)}', flush=True)
    for line in (*figures.problems, *(f'goal missed: {goal}' for goal in missed_goals(figures))):
        print(f'    {line}', flush=True)


if __name__ == '__main__':
    sys.exit(main())

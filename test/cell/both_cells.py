"""What the nodes in lock-step and the simulation must have in common: all they do, to the last bit."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robots_controller.program.files.program_header import read_program_header
from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.simulate import simulate
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.validation import Array

from .bag_checks import changes
from .lockstep_runs import LockstepRun

IMAGES = ('digital_outputs', 'analog_outputs', 'digital_inputs', 'analog_inputs')
FIRST = 1.0  # s, of the first period
# Messages of one instant are some nanoseconds apart. No instant is half a tick beside a whole one.
TICK = 10_000  # ns


@dataclass(frozen=True, eq=False)
class Runs:
    """A program, run in lock-step and simulated."""

    lockstep: LockstepRun
    simulation: SimulationRun
    recorded: Bag
    simulated: Bag


def check_both_cells(lockstep: LockstepRun, drive: str, bag: Path, **options: Any) -> None:
    """Simulate what has run in lock-step, into a bag and with these options, and compare."""
    header = read_program_header(lockstep.program)
    options |= {
        'robot': header.robot,
        'scene': header.scene,
        'io': header.io,
        'references': header.references,
        'contact': header.contact,
        'orbit': header.orbit,
        'cabin': header.cabin,
    }
    run = simulate(lockstep.program, drive=drive, rate=lockstep.rate, bag=bag, **options)
    assert lockstep.returncode == (0 if run.ok else 1), lockstep.text
    logs = [file.read_text() for file in lockstep.bag.parent.glob('log/*.log')]
    assert logs
    assert not any('Traceback' in log for log in logs), logs
    runs = Runs(lockstep, run, read_bag(lockstep.bag), read_bag(bag))
    check_references_and_feedback_to_the_last_bit(runs)
    check_results_states_and_lines(runs)
    for image in IMAGES:
        check_changes(runs, image)
    check_end(runs)


def check_references_and_feedback_to_the_last_bit(runs: Runs) -> None:
    run, found = runs.simulation, runs.recorded.deserialized(['/joint_reference', '/joint_states'])
    references = {_stamp(m): _rows(m.points[0]) for _, m in found['/joint_reference']}
    states = {_stamp(m): np.array([m.position, m.velocity]) for _, m in found['/joint_states']}
    stamps = [round((FIRST + time) * 1e9) for time in run.time]
    assert stamps == [stamp for stamp in stamps if stamp in references and stamp in states]
    np.testing.assert_array_equal(np.array([references[stamp] for stamp in stamps]), run.reference)
    measured = np.array([states[stamp] for stamp in stamps])
    np.testing.assert_array_equal(measured, np.stack([run.position, run.velocity], axis=1))


def check_results_states_and_lines(runs: Runs) -> None:
    end = _end(runs)
    for topic, read in (
        ('/motion_result', lambda m: (m.message, _value(m, 'id'), _value(m, 'duration'))),
        ('/command_state', lambda m: m.data),
        ('/joint_trajectory', lambda m: (_stamp(m), [_rows(point).ravel().tolist() for point in m.points])),
    ):
        there, here = (_timed(bag, topic, read, end) for bag in (runs.recorded, runs.simulated))
        assert there == here, f'{topic}: {_difference(there, here)}'


def check_changes(runs: Runs, image: str) -> None:
    end = _end(runs)
    there, here = (
        [
            (round(stamp / TICK), channel, value)
            for stamp, channel, value in _changes(bag, image)
            if 1e-9 * stamp < end  # a PLC continues until the nodes end
        ]
        for bag in (runs.recorded, runs.simulated)
    )
    assert there == here, f'{image}: {_difference(there, here)}'


def check_end(runs: Runs) -> None:
    there, here = (
        [
            (_value(m, 'state'), _value(m, 'error'), _value(m, 'line'))
            for m in _messages(bag, '/program_status')
        ]
        for bag in (runs.recorded, runs.simulated)
    )
    assert there[-1] == here[-1]


def _messages(bag: Bag, topic: str) -> list[Any]:
    return [message for _, message in bag.deserialized([topic])[topic]]


def _timed(bag: Bag, topic: str, read: Any, end: float) -> list[Any]:
    """What came in which tick; within one the order of topics and nodes does not count."""
    found = [
        (round(stamp / TICK), read(message))
        for stamp, message in bag.deserialized([topic])[topic]
        if 1e-9 * stamp < end
    ]
    return sorted(found)


def _difference(there: list[Any], here: list[Any]) -> str:
    """What one of the two cells has and the other has not, with the number of the rest."""
    only_there, only_here = ([one for one in a if one not in b] for a, b in ((there, here), (here, there)))
    return f'only in lock-step {only_there}, only simulated {only_here}, of {len(there)} and {len(here)}'


def _end(runs: Runs) -> float:
    """Behind the last instant of the simulation, s."""
    return FIRST + float(runs.simulation.time[-1]) + 1e-3


def _changes(bag: Bag, image: str) -> list[tuple[float, int, float]]:
    return list(changes(bag.deserialized([f'/{image}']), image))


def _stamp(message: Any) -> int:
    return int(message.header.stamp.sec) * 1_000_000_000 + int(message.header.stamp.nanosec)


def _rows(point: Any) -> Array:
    return np.array([point.positions, point.velocities, point.accelerations])


def _value(status: Any, key: str) -> str:
    return str(next((pair.value for pair in status.values if pair.key == key), ''))

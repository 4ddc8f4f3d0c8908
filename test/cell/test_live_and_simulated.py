"""A program does the same in a live cell and in a simulated one."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.recording.bag_comparison import compare_bags
from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.bag_tolerances import BagTolerances, TopicTolerance
from robots_controller.simulate import simulate
from robots_planning.motion_results import PASSED

from .bag_checks import changes
from .live_runs import LiveRuns

ROBOT = 'kuka_kr210_r2700'
# Plans are computed from the same numbers; what could differ is the last digit of a sum.
SAME = 1e-9
# Messages and planning take their time in a live cell, and more on a busy machine: order counts, not time.
ANY_TIME = 60.0  # s
# Both count periods of the controller; the feedback that a motion's end waits for comes at any of them.
SETTLING = 0.1  # s
# Messages that come every 4 ms are late after this; then the machine has held up who sends them.
LATE = 0.02  # s
# Live references are under way and wait for the drives' next period of 4 ms.
UNDER_WAY = 0.008  # s
IMAGES = ('digital_outputs', 'analog_outputs', 'digital_inputs', 'analog_inputs')
IDS = (('header.stamp', None),)
COMMANDS = ('ptpjoint_joint', 'ptpjoint_cartesian', 'ptpcartesian')
TOLERANCES = {
    **dict.fromkeys(
        ('command_state', 'digital_outputs', 'analog_outputs'),
        TopicTolerance(mode='changes', time=ANY_TIME),
    ),
    **dict.fromkeys(
        (*COMMANDS, 'joint_trajectory'), TopicTolerance(time=ANY_TIME, absolute=SAME, fields=IDS)
    ),
}
EVENTS = ('/command_state', '/digital_outputs', '/motion_result')


@dataclass(frozen=True)
class Case:
    """A program.

    Attributes:
        program: File name.
        motions: How many it commands.
        timed: Digital outputs that switch when a time is over, whatever the program does then.
        early: Inputs that a live PLC, which starts before the program, may have set before that.
    """

    program: str
    motions: int
    timed: tuple[int, ...] = ()
    early: int = 0


CASES = (
    Case('welding.lua', 4),
    # Two subprograms, a tool and bases; its corners blend.
    Case('palletizing.lua', 14),
    # A PLC answers its outputs; a pulse ends while the robot moves.
    Case('press_tending.lua', 16, timed=(3,), early=1),
)


@dataclass(frozen=True)
class Runs:
    """A program's live bag and its simulated one."""

    case: Case
    live: Bag
    simulated: Bag

    @property
    def bags(self) -> tuple[Bag, Bag]:
        return self.live, self.simulated


@pytest.fixture(scope='module', params=CASES, ids=lambda case: case.program)
def runs(
    request: pytest.FixtureRequest, live_runs: LiveRuns, tmp_path_factory: pytest.TempPathFactory
) -> Runs:
    """A program, run in both cells."""
    case: Case = request.param
    live = live_runs.run(case.program)
    assert live.cell.process.returncode == 0, live.cell.text
    bag = tmp_path_factory.mktemp('simulated') / 'bag'
    plc = live.program.parent / 'io' / f'{live.program.stem}.yaml'
    run = simulate(live.program, robot=ROBOT, io=plc if plc.is_file() else '', bag=bag)
    assert run.ok, run.error
    return Runs(case, read_bag(live.cell.bag), read_bag(bag))


def test_commands_plans_and_results_are_the_same(runs: Runs):
    # Only what the program uses; topics that are told of have to be there.
    told = {topic: item for topic, item in TOLERANCES.items() if _counted(runs.simulated, f'/{topic}')}
    tolerances = BagTolerances(topics={'*': TopicTolerance(mode='ignore'), **told}, align='command_state')
    comparison = compare_bags(runs.live, runs.simulated, tolerances)
    assert comparison.ok, comparison.describe()
    assert {'/command_state', '/joint_trajectory'} <= {t.topic for t in comparison.topics}
    live, simulated = (_results(bag) for bag in runs.bags)
    assert live == simulated


def test_motions_take_as_long(runs: Runs):
    live, simulated = (_details(bag, 'duration') for bag in runs.bags)
    assert len(live) == runs.case.motions
    behind, usual = ([float(lags.max()) for lags in _lags(bag)] for bag in runs.bags)
    # A busy machine makes the controller wait, or the drives, which take references when they are let.
    held_up = np.array(_gaps(runs.live)) + np.maximum(np.subtract(behind, usual), 0.0)
    for real, expected, waited in zip(live, simulated, held_up, strict=True):
        assert expected - SETTLING < real < expected + SETTLING + waited


def test_feedback_follows_references_as_closely(runs: Runs):
    live, simulated = (float(np.median(np.concatenate(_lags(bag)))) for bag in runs.bags)
    assert abs(live - simulated) < UNDER_WAY


def test_states_results_and_outputs_come_in_the_same_order(runs: Runs):
    live, simulated = (_events(bag, without=runs.case.timed) for bag in runs.bags)
    assert live == simulated
    assert ('/digital_outputs', (1, 1.0)) in simulated


@pytest.mark.parametrize('image', IMAGES)
def test_each_input_and_output_takes_the_same_values(runs: Runs, image: str):
    live, simulated = (_channels(bag, image) for bag in runs.bags)
    late = {channel: values[-len(live.get(channel, [0.0])) :] for channel, values in simulated.items()}
    assert live == late
    missing = sum(map(len, simulated.values())) - sum(map(len, live.values()))
    assert 0 <= missing <= (runs.case.early if image.endswith('inputs') else 0)


def test_the_references_follow_the_same_path(runs: Runs):
    # The same plan, sampled from the same start in the same periods: what is left is the time of standing.
    live, simulated = (_moving_references(bag) for bag in runs.bags)
    assert live.shape == simulated.shape
    assert live == pytest.approx(simulated, abs=SAME)


def test_a_live_recording_has_no_other_topics(runs: Runs):
    live, simulated = ({topic for topic in bag.topics if _counted(bag, topic)} for bag in runs.bags)
    # What the middleware and the processes tell of themselves.
    assert live - simulated <= {'/diagnostics', '/parameter_events', '/rosout'}
    both = live & simulated
    for what in ('type', 'latched'):
        kinds = [{topic: getattr(bag.topics[topic], what) for topic in both} for bag in runs.bags]
        assert kinds[0] == kinds[1]


def _counted(bag: Bag, topic: str) -> bool:
    return any(name == topic for name, _, _ in bag.messages)


def _events(bag: Bag, *, without: tuple[int, ...]) -> list[tuple[str, Any]]:
    """What happened, in order, without its times and without some digital outputs."""
    found = bag.deserialized(EVENTS)
    messages = {topic: iter(found[topic]) for topic in EVENTS}
    in_order = [(topic, next(messages[topic])[1]) for topic, _, _ in bag.messages if topic in EVENTS]
    events: list[tuple[str, Any]] = []
    image = np.zeros(0)
    for topic, message in in_order:
        if topic == '/digital_outputs':
            before, image = image, np.array(message.data, float)
            if before.size:
                changed = [int(i) + 1 for i in np.flatnonzero(before != image)]
                events += [(topic, (index, image[index - 1])) for index in changed if index not in without]
        elif topic == '/command_state':
            events.append((topic, message.data))
        elif message.message != PASSED:  # told by another node than the end of the chain
            events.append((topic, message.message))
    return events


def _channels(bag: Bag, image: str) -> dict[int, list[float]]:
    """What each channel of an image changed to, in order."""
    found: dict[int, list[float]] = {}
    for _, channel, value in changes(bag.deserialized([f'/{image}']), image):
        found.setdefault(channel, []).append(value)
    return found


def _results(bag: Bag) -> list[str]:
    """What became of the commands, in their order."""
    results = [message for _, message in bag.deserialized(['/motion_result'])['/motion_result']]
    return [result.message for result in sorted(results, key=_id)]


def _id(result: Any) -> int:
    return int(next(pair.value for pair in result.values if pair.key == 'id').replace('.', ''))


def _details(bag: Bag, key: str) -> list[float]:
    """A number that motion results tell, in their order."""
    results = [message for _, message in bag.deserialized(['/motion_result'])['/motion_result']]
    return [float(pair.value) for result in results for pair in result.values if pair.key == key]


def _windows(bag: Bag) -> list[tuple[float, float]]:
    """When each motion began and ended, s."""
    ends = _details(bag, 'ended')
    return [(end - duration, end) for end, duration in zip(ends, _details(bag, 'duration'), strict=True)]


def _stamped(bag: Bag) -> tuple[Any, Any, Any, Any]:
    """Times and positions of references, then those of feedback, (k,) and (k, n) each."""
    found = bag.deserialized(['/joint_reference', '/joint_states'])
    references = [message for _, message in found['/joint_reference']]
    states = [message for _, message in found['/joint_states']]
    return (
        np.array([_seconds(message.header.stamp) for message in references]),
        np.array([message.points[0].positions for message in references]),
        np.array([_seconds(message.header.stamp) for message in states]),
        np.array([message.position for message in states]),
    )


def _seconds(stamp: Any) -> float:
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def _gaps(bag: Bag) -> list[float]:
    """For how long no references or no feedback came during each motion, s."""
    sent, _, measured, _ = _stamped(bag)
    gaps = [
        (before, after)
        for times in (sent, measured)
        for before, after in itertools.pairwise(times)
        if after - before > LATE
    ]
    return [
        sum(max(min(after, end) - max(before, begin), 0.0) for before, after in gaps)
        for begin, end in _windows(bag)
    ]


def _lags(bag: Bag) -> list[Any]:
    """How long before each feedback of a motion the reference was where that is, or nearest to it, (k,) s.

    Of feedback on the way: what comes once the target is reached tells of a controller that does not end.
    """
    sent, wanted, measured, reached = _stamped(bag)
    lags = []
    for begin, end in _windows(bag):
        then = (sent >= begin) & (sent <= end)
        left = np.abs(reached - wanted[then][-1]).max(axis=1)
        now = (measured >= begin) & (measured <= end) & (left > ControllerSettings().goal_tolerance)
        distances = np.linalg.norm(reached[now][:, None] - wanted[then][None], axis=2)
        lags.append(measured[now] - sent[then][np.argmin(distances, axis=1)])
    return lags


def _moving_references(bag: Bag) -> Any:
    """Positions of the reference, without repetitions."""
    positions = [
        message.points[0].positions
        for _, message in bag.deserialized(['/joint_reference'])['/joint_reference']
    ]
    changes = [new for old, new in itertools.pairwise(positions) if not np.array_equal(old, new)]
    return np.array([positions[0], *changes])

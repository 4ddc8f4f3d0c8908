"""A program does the same in a live cell and in a simulated one."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.bag_comparison import compare_bags
from robots_controller.bag_file import Bag, read_bag
from robots_controller.bag_tolerances import BagTolerances, TopicTolerance
from robots_controller.simulate import simulate

from .cell_process import CellProcess
from .conftest import PROGRAMS

ROBOT = 'kuka_kr210_r2700'
PROGRAM = PROGRAMS / 'welding.lua'
# Plans are computed from the same numbers; what could differ is the last digit of a sum.
SAME = 1e-9
# Messages and planning take their time in a live cell, and more on a busy machine: order counts, not time.
ANY_TIME = 60.0  # s
# Both count periods of the controller; the feedback that a motion's end waits for comes at any of them.
SETTLING = 0.1  # s
IDS = (('header.stamp', None),)
TOLERANCES = BagTolerances(
    topics={
        '*': TopicTolerance(mode='ignore'),
        'command_state': TopicTolerance(mode='changes', time=ANY_TIME),
        'digital_outputs': TopicTolerance(mode='changes', time=ANY_TIME),
        'analog_outputs': TopicTolerance(mode='changes', time=ANY_TIME),
        'ptpjoint_joint': TopicTolerance(time=ANY_TIME, absolute=SAME, fields=IDS),
        'ptpcartesian': TopicTolerance(
            time=ANY_TIME, absolute=SAME, fields=(*IDS, ('poses[*].header.stamp', None))
        ),
        'joint_trajectory': TopicTolerance(time=ANY_TIME, absolute=SAME, fields=IDS),
        'motion_result': TopicTolerance(
            time=ANY_TIME,
            fields=(('values.id', None), ('values.ended', None), ('values.duration', None)),
        ),
    },
    align='command_state',
)
EVENTS = ('/command_state', '/digital_outputs', '/motion_result')


@pytest.fixture(scope='module')
def bags(module_ros_domain: int, tmp_path_factory: pytest.TempPathFactory) -> tuple[Bag, Bag]:
    """The live bag and the simulated one."""
    del module_ros_domain
    folder: Path = tmp_path_factory.mktemp('runs')
    process = CellProcess(
        '--robot', ROBOT, '--program', str(PROGRAM), '--once', '--port', '0', out=folder / 'live'
    )
    try:
        assert process.wait() == 0, process.text
    finally:
        process.close()
    run = simulate(PROGRAM, robot=ROBOT, bag=folder / 'simulated')
    assert run.ok
    return read_bag(process.bag), read_bag(folder / 'simulated')


def test_commands_plans_and_results_are_the_same(bags: tuple[Bag, Bag]):
    live, simulated = bags
    comparison = compare_bags(simulated, live, TOLERANCES)
    assert comparison.ok, comparison.describe()
    assert {'/command_state', '/joint_trajectory', '/motion_result'} <= {t.topic for t in comparison.topics}


def test_motions_take_as_long(bags: tuple[Bag, Bag]):
    live, simulated = (_durations(bag) for bag in bags)
    assert len(live) == 4
    assert live == pytest.approx(simulated, abs=SETTLING)


def test_states_results_and_outputs_come_in_the_same_order(bags: tuple[Bag, Bag]):
    live, simulated = (_events(bag) for bag in bags)
    assert live == simulated
    assert ('/digital_outputs', (1, 1.0)) in simulated


def test_the_references_follow_the_same_path(bags: tuple[Bag, Bag]):
    # The same plan, sampled from the same start in the same periods: what is left is the time of standing.
    live, simulated = (_moving_references(bag) for bag in bags)
    assert live.shape == simulated.shape
    assert live == pytest.approx(simulated, abs=SAME)


def test_a_live_recording_has_no_other_topics(bags: tuple[Bag, Bag]):
    live, simulated = ({topic for topic in bag.topics if _counted(bag, topic)} for bag in bags)
    # What the middleware and the processes tell of themselves.
    assert live - simulated <= {'/diagnostics', '/parameter_events', '/rosout'}
    both = live & simulated
    for what in ('type', 'latched'):
        kinds = [{topic: getattr(bag.topics[topic], what) for topic in both} for bag in bags]
        assert kinds[0] == kinds[1]


def _counted(bag: Bag, topic: str) -> bool:
    return any(name == topic for name, _, _ in bag.messages)


def _events(bag: Bag) -> list[tuple[str, Any]]:
    """What happened, in order, without its times."""
    found = bag.deserialized(EVENTS)
    messages = {topic: iter(found[topic]) for topic in EVENTS}
    in_order = [(topic, next(messages[topic])[1]) for topic, _, _ in bag.messages if topic in EVENTS]
    events: list[tuple[str, Any]] = []
    image = np.zeros(0)
    for topic, message in in_order:
        if topic == '/digital_outputs':
            before, image = image, np.array(message.data, float)
            if before.size:
                changed = np.flatnonzero(before != image).tolist()
                events += [(topic, (index + 1, image[index])) for index in changed]
        elif topic == '/command_state':
            events.append((topic, message.data))
        else:
            events.append((topic, message.message))
    return events


def _durations(bag: Bag) -> list[float]:
    results = [message for _, message in bag.deserialized(['/motion_result'])['/motion_result']]
    return [float(pair.value) for result in results for pair in result.values if pair.key == 'duration']


def _moving_references(bag: Bag) -> Any:
    """Positions of the reference, without repetitions."""
    positions = [
        message.points[0].positions
        for _, message in bag.deserialized(['/joint_reference'])['/joint_reference']
    ]
    changes = [new for old, new in itertools.pairwise(positions) if not np.array_equal(old, new)]
    return np.array([positions[0], *changes])

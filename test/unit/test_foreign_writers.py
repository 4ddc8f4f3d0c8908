"""ForeignWriters: nodes without a place on a topic stop the robot while they are there."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from robots_controller.control.stops.faults import Fault
from robots_controller.control.stops.foreign_writers import OTHERS, TO_DRIVES, ForeignWriters
from robots_core.cell_interface.topic_writers import WRITERS

from .control_rig import ControlRig

OWN = {topic: {f'/{name}' for name in WRITERS[topic].nodes} for topic in (*TO_DRIVES, *OTHERS)}


class Publishers:
    """Which nodes publish what, around a control loop."""

    def __init__(self, *, identified: bool) -> None:
        self.rig = ControlRig()
        self.writers = ForeignWriters(self.rig.loop, '/', identified=identified)
        self.names: Mapping[str, set[str]] = OWN

    def join(self, topic: str, *names: str) -> None:
        """These nodes publish a topic besides the suite's."""
        self.names = {**OWN, topic: OWN[topic] | {*names}}

    @property
    def suspected(self) -> bool:
        return self.writers.suspected(lambda topic: len(self.names[topic]))

    def fault(self) -> Fault | None:
        """Look; returns what stops the robot."""
        self.writers.check(self.names.__getitem__)
        self.rig.run(1)
        return self.rig.stops[-1].fault


@pytest.mark.parametrize('identified', [False, True])
def test_the_suite_alone_stops_nothing(identified: bool) -> None:  # noqa: FBT001
    publishers = Publishers(identified=identified)
    assert publishers.suspected is not identified
    assert publishers.fault() is None


@pytest.mark.parametrize('topic', [*TO_DRIVES, *OTHERS])
@pytest.mark.parametrize('identified', [False, True])
def test_a_stranger_stops_the_robot_where_its_messages_are_not_dropped(
    topic: str,
    identified: bool,  # noqa: FBT001
) -> None:
    publishers = Publishers(identified=identified)
    publishers.join(topic, '/stranger')
    stops = topic in TO_DRIVES or not identified
    assert publishers.suspected is stops
    assert publishers.fault() is (Fault.FOREIGN_WRITER if stops else None)
    assert publishers.rig.stops[-1].reason == (f'/stranger publishes {topic}' if stops else '')


def test_the_robot_may_move_again_when_the_stranger_is_gone_and_after_a_reset() -> None:
    publishers = Publishers(identified=True)
    publishers.join('drives_on', '/b', '/a')
    assert publishers.fault() is Fault.FOREIGN_WRITER
    assert publishers.rig.stops[-1].reason == '/a, /b publishes drives_on'
    publishers.names = OWN
    assert publishers.suspected
    assert publishers.fault() is Fault.FOREIGN_WRITER
    assert not publishers.suspected
    publishers.rig.loop.reset()
    assert publishers.fault() is None

"""Streams of a bag as arrays: at once where messages are alike, and one by one where they are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import JointRows, joint_rows, late_references, seconds
from robots_controller.recording.message_rows import MessageRows
from robots_controller.simulation.record import ros_messages as ros
from robots_core import load_robot_model
from robots_core.errors import RobotsError
from written_bags import write_bag

ROBOT = load_robot_model('kuka_kr210_r2700')
NAMES = ROBOT.axes_data.names
RANDOM = np.random.default_rng(8)
STATES = RANDOM.normal(size=(5, 3, 6))


def state(k: int, names: tuple[str, ...] = NAMES, count: int = 3) -> Any:
    columns = [NAMES.index(name) for name in names]
    return ros.BUILD.joint_state(1_700_000_000_123_456_789 + k, names, *STATES[k][:count, columns].copy())


def reference(k: int) -> Any:
    return ros.BUILD.joint_trajectory(
        1_700_000_000_123_456_789 + k, NAMES[::-1], [(4_000_000, *STATES[k][:, ::-1].copy())]
    )


def test_references_are_read_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    bag = read_bag(write_bag(tmp_path / 'bag', [(0.1 * k, '/r', reference(k)) for k in range(5)]))
    rows = joint_rows(bag, '/r', ROBOT)
    monkeypatch.setattr(MessageRows, 'read', lambda *_: None)
    for each in (rows, joint_rows(bag, '/r', ROBOT)):
        assert np.array_equal(np.stack(each.values, axis=1), STATES)  # type: ignore[arg-type]
        assert each.sent.tolist() == [stamp for _, stamp, _ in bag.messages]
        assert each.stamp.tolist() == [1_700_000_000_123_456_789 + k for k in range(5)]
        assert each.period == 0.004


@pytest.mark.parametrize('count', [1, 2, 3])
def test_what_states_do_not_contain_is_none(tmp_path: Path, count: int):
    bag = read_bag(write_bag(tmp_path / 'bag', [(0.1 * k, '/s', state(k, count=count)) for k in range(5)]))
    values = joint_rows(bag, '/s', ROBOT).values
    assert [rows is not None for rows in values] == [number < count for number in range(3)]
    assert np.array_equal(values[0], STATES[:, 0])


def test_joints_are_matched_by_name_in_every_message(tmp_path: Path):
    orders = [NAMES, NAMES[::-1], (*NAMES[3:], *NAMES[:3]), ('other', *NAMES)[1:], NAMES[::-1]]
    messages = [(0.1 * k, '/s', state(k, names)) for k, names in enumerate(orders)]
    bag = read_bag(write_bag(tmp_path / 'bag', messages))
    rows = joint_rows(bag, '/s', ROBOT)
    assert np.array_equal(np.stack(rows.values, axis=1), STATES)  # type: ignore[arg-type]
    found = bag.deserialized(['/s'])['/s']
    assert [seconds(message.header.stamp) for _, message in found] == pytest.approx(1e-9 * rows.stamp)


def test_a_topic_without_messages_has_no_rows(tmp_path: Path):
    bag = read_bag(write_bag(tmp_path / 'bag', [(0.0, '/s', state(0))]))
    assert joint_rows(bag, '/r', ROBOT).sent.size == 0


def test_a_joint_that_is_missing_is_reported(tmp_path: Path):
    bag = read_bag(write_bag(tmp_path / 'bag', [(0.0, '/cell/s', state(0, NAMES[1:]))]))
    with pytest.raises(RobotsError, match='s of the bag lacks joint A1 of kuka_kr210_r2700: it has A2, A3'):
        joint_rows(bag, '/cell/s', ROBOT)


PERIOD = 0.004  # s


def moving(ticks: list[int], due: list[float], speed: float = 0.7) -> JointRows:
    """References of a robot at constant speed: where it is by tick, and when each was due."""
    stamp = np.round(1e9 * PERIOD * np.array(due)).astype(np.int64)
    q = speed * PERIOD * np.array(ticks)[:, None]
    return JointRows(stamp, stamp, (q, np.full_like(q, speed), np.zeros_like(q)), PERIOD)


def test_lost_messages_are_not_late() -> None:
    assert not late_references(moving([0, 1, 2, 5, 6], [0, 1, 2, 5, 6])).any()


def test_a_controller_that_was_held_up_goes_on_from_where_it_was() -> None:
    late = late_references(moving([0, 1, 2, 3, 4], [0, 1, 2, 18, 19]))
    np.testing.assert_allclose(late, [0.0, 0.0, 0.0, 15 * PERIOD, 0.0], atol=1e-12)


def test_a_robot_that_stands_is_never_late() -> None:
    assert not late_references(moving([0, 0, 0], [0, 1, 40], speed=0.0)).any()


def test_jitter_of_the_stamps_does_not_matter() -> None:
    due = [k + (-1) ** k * 0.2 for k in range(6)]
    assert not late_references(moving(list(range(6)), due, speed=2.5)).any()

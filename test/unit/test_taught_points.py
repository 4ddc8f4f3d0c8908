"""Points files: what is written is read again, and what is wrong is named."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robots_controller.program.files.taught_points import TaughtPoint, read_points, write_points
from robots_core import Pose
from robots_core.errors import ProgramError

AXES = 3
numbers = st.floats(-10.0, 10.0, allow_subnormal=False)
points = st.builds(
    lambda q, r, angles: TaughtPoint(q, Pose.from_angles(r, angles)),
    arrays(np.float64, AXES, elements=numbers),
    arrays(np.float64, 3, elements=numbers),
    arrays(np.float64, 3, elements=st.floats(-3.0, 3.0)),
)
names = st.text(min_size=1, max_size=12).filter(lambda text: text.isprintable())


@given(st.dictionaries(names, points, max_size=4))
@settings(max_examples=40)
def test_what_is_written_is_read_again(taught: dict[str, TaughtPoint]) -> None:
    with tempfile.TemporaryDirectory() as folder:  # one per example, which pytest's tmp_path is not
        path = Path(folder) / 'part.points.yaml'
        write_points(path, taught)
        read = read_points(path, AXES)
        assert list(path.parent.iterdir()) == [path]  # nothing else is left behind
    assert read.keys() == taught.keys()
    for name, point in taught.items():
        np.testing.assert_array_equal(read[name].q, point.q)
        np.testing.assert_array_equal(read[name].pose.r, point.pose.r)
        # The orientation travels as a quaternion, which rounds.
        assert read[name].pose.distance_to(point.pose)[1] < 1e-7
        assert not read[name].q.flags.writeable


def test_no_file_is_no_points(tmp_path: Path) -> None:
    assert read_points(tmp_path / 'none.points.yaml', AXES) == {}


def test_a_file_states_its_units(tmp_path: Path) -> None:
    path = tmp_path / 'part.points.yaml'
    write_points(path, {'home': TaughtPoint(np.zeros(AXES), Pose.identity())})
    lines = path.read_text().splitlines()
    assert lines[0].startswith('# Taught points. q: joint positions, rad')
    assert 'home' in path.read_text()


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('points:\n  a: {q: [0, 0, 0], r: [0, 0, 0], quaternion: [0, 0, 0, 1]}\n  home: 3', 'yaml:3: point'),
        ('points:\n  a: {q: [0, 0, 0]\n  b: 1', 'yaml:3: '),
        ('points: [', 'the points file cannot be read'),
        ('- a list', "one key 'points'"),
        ('points: 3', "one key 'points'"),
        ('points: {home: 3}', "point 'home': a point has q, r and quaternion"),
        ('points: {home: {q: [0, 0, 0], r: [0, 0, 0]}}', "point 'home': a point has q, r and quaternion"),
        ('points: {home: {q: [0, 0], r: [0, 0, 0], quaternion: [0, 0, 0, 1]}}', "point 'home': q"),
        ('points: {home: {q: [0, 0, .nan], r: [0, 0, 0], quaternion: [0, 0, 0, 1]}}', "point 'home': q"),
        ('points: {home: {q: [0, 0, 0], r: [0, 0, 0], quaternion: [0, 0, 0, 0]}}', 'length 0'),
        ('points: {home: {q: [0, 0, 0], r: [0, x, 0], quaternion: [0, 0, 0, 1]}}', "point 'home': r"),
        ('points: !!python/object/apply:os.system [ls]', 'the points file cannot be read'),
    ],
)
def test_a_wrong_file_is_named_with_what_is_wrong(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / 'wrong.points.yaml'
    path.write_text(text)
    with pytest.raises(ProgramError, match=r'wrong\.points\.yaml') as caught:
        read_points(path, AXES)
    assert message in str(caught.value)


def test_bytes_that_are_no_text_are_reported(tmp_path: Path) -> None:
    path = tmp_path / 'wrong.points.yaml'
    path.write_bytes(b'\xff\xfe\x00points')
    with pytest.raises(ProgramError, match='cannot be read'):
        read_points(path, AXES)


def test_a_file_that_cannot_be_written_keeps_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / 'gone' / 'part.points.yaml'
    with pytest.raises(ProgramError, match='the points file cannot be written: No such file or directory'):
        write_points(path, {})
    old = tmp_path / 'part.points.yaml'
    write_points(old, {'home': TaughtPoint(np.zeros(AXES), Pose.identity())})
    before = old.read_text()
    with pytest.raises(AttributeError):
        write_points(old, {'home': None})  # type: ignore[dict-item]
    assert old.read_text() == before
    assert list(tmp_path.iterdir()) == [old]

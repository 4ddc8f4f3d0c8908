"""Teaching: points and motions are written whole, found again by programs, and taken back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.program.teaching import Teaching, free_name
from robots_controller.simulate import simulate
from robots_core import Pose, load_robot_model
from robots_core.errors import InvalidInputError, ProgramError, RobotsError

ROBOT = 'kuka_kr210_r2700'
PLACES = np.radians(
    [[10, -80, 80, 5, 40, 0], [20, -75, 80, 5, 45, 10], [25, -80, 85, 0, 45, 10], [30, -85, 85, 0, 50, 0]]
)
TOOL = (0, 0.1, 0.3, 20, 10, 5)  # m, deg
PROGRAM = f"""setTool{TOOL}
setBase(0.5, 0.2, 0, 30, 0, 0)
for _ = 1, 1 do
  setOverride(1)
end
"""


@pytest.fixture
def teaching() -> Teaching:
    return Teaching(load_robot_model(ROBOT))


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / 'part.lua'
    path.write_text(PROGRAM)
    return path


def points_of(program: Path) -> Path:
    return program.with_suffix('.points.yaml')


def test_a_program_of_taught_motions_reaches_the_points(teaching: Teaching, program: Path) -> None:
    file = points_of(program)
    line = teaching.insert(file, program, 4, motion='ptp', names=['P1'], q=PLACES[0])
    line = teaching.insert(file, program, line, motion='line', names=["P'2"], q=PLACES[1])
    teaching.teach(file, 'via', PLACES[2])
    line = teaching.insert(file, program, line, motion='arc', names=['via', 'P4'], q=PLACES[3])
    assert line == 7
    assert program.read_text().split('\n')[4:7] == [
        "  ptpJointSpaceAngles((getTaughtPoint('P1')))",
        "  ptpCartesianSpace(getTaughtPose('P\\'2'))",
        "  circCartesianSpace(getTaughtPose('via'), getTaughtPose('P4'))",
    ]
    robot = load_robot_model(ROBOT)
    run = simulate(program, robot=ROBOT)
    assert run.error is None, run.error
    tool = Pose.from_angles(TOOL[:3], np.radians(TOOL[3:]), robot.orientation_convention)
    way = np.array([(Pose(*robot.direct_kinematics(q)) @ tool).r for q in run.reference[:, 0]])
    for q in PLACES:
        place = (Pose(*robot.direct_kinematics(q)) @ tool).r
        assert np.linalg.norm(way - place, axis=1).min() < 2e-3
    np.testing.assert_allclose(run.reference[:, 0][-1], PLACES[3], atol=1e-5)


def test_changes_are_taken_back_one_after_the_other_to_the_byte(teaching: Teaching, program: Path) -> None:
    file = points_of(program)
    program.write_bytes(PROGRAM.replace('\n', '\r\n').encode())
    before: list[tuple[bytes, bytes | None]] = [(program.read_bytes(), None)]
    for number, q in enumerate(PLACES[:3]):
        teaching.insert(file, program, 0, motion='ptp', names=[f'P{number}'], q=q)
        before.append((program.read_bytes(), file.read_bytes()))
    for text, points in reversed(before[:-1]):
        teaching.history.undo()
        assert program.read_bytes() == text
        assert (file.read_bytes() if file.exists() else None) == points
    assert [one.name for one in program.parent.iterdir()] == ['part.lua']
    with pytest.raises(ProgramError, match='nothing to undo'):
        teaching.history.undo()


def test_what_another_one_has_changed_since_is_not_undone(teaching: Teaching, program: Path) -> None:
    teaching.insert(points_of(program), program, 0, motion='ptp', names=['P1'], q=PLACES[0])
    program.write_text('-- written by hand\n')
    with pytest.raises(ProgramError, match=r'part\.lua: changed since'):
        teaching.history.undo()
    assert program.read_text() == '-- written by hand\n'
    assert points_of(program).exists()


def test_a_point_is_touched_up_and_the_others_stay(teaching: Teaching, program: Path) -> None:
    file = points_of(program)
    for name, q in zip(('P1', 'P2', 'P1'), PLACES[:3], strict=True):
        teaching.teach(file, name, q)
    points = teaching.points(file)
    assert [*points] == ['P1', 'P2']
    np.testing.assert_array_equal(points['P1'].q, PLACES[2])
    assert free_name(points) == 'P3'


def test_a_file_broken_by_hand_is_named_with_its_line_and_stays(teaching: Teaching, program: Path) -> None:
    file = points_of(program)
    broken = (
        'points:\n  P1: {q: [0, 0, 0, 0, 0, 0], r: [0, 0, 0], quaternion: [0, 0, 0, 1]}\n  P2: {q: [0, 0\n'
    )
    file.write_text(broken)
    with pytest.raises(ProgramError, match=r'part\.points\.yaml:\d: '):
        teaching.teach(file, 'P3', PLACES[0])
    with pytest.raises(ProgramError, match=r'part\.points\.yaml:\d: '):
        teaching.insert(file, program, 0, motion='ptp', names=['P3'], q=PLACES[0])
    assert file.read_text() == broken
    assert program.read_text() == PROGRAM


@pytest.mark.parametrize(
    ('request_', 'error'),
    [
        ((99, 'ptp', ['P1']), r'line = 99 must be in \[0, 6\] of part\.lua'),
        ((0, 'spline', ['P1']), "motion 'spline' is unknown; valid are ptp, line, arc"),
        ((0, 'arc', ['P1']), 'an arc has two'),
        ((0, 'arc', ['none', 'P1']), "no point is named 'none'"),
        ((0, 'ptp', [' ']), 'name of the point is empty'),
    ],
)
def test_odd_requests_change_nothing(
    teaching: Teaching, program: Path, request_: tuple[int, Any, list[str]], error: str
) -> None:
    line, motion, names = request_
    with pytest.raises(RobotsError, match=error):
        teaching.insert(points_of(program), program, line, motion=motion, names=names, q=PLACES[0])
    assert program.read_text() == PROGRAM
    assert not points_of(program).exists()
    assert len(teaching.history) == 0


def test_a_folder_that_is_gone_leaves_all_as_it_was(teaching: Teaching, program: Path) -> None:
    gone = program.parent / 'gone' / 'a.yaml'
    with pytest.raises(ProgramError, match='cannot be written'):
        teaching.insert(gone, program, 0, motion='ptp', names=['P1'], q=PLACES[0])
    assert program.read_text() == PROGRAM
    with pytest.raises(InvalidInputError, match='empty'):
        teaching.teach(points_of(program), '', PLACES[0])

from __future__ import annotations

import itertools
import json
import sys
from pathlib import Path

import pytest
from pyarrow import csv, parquet

from robots_controller.commands.command_table import STUDY as STUDY_COMMAND
from robots_controller.study.run_case import FIGURES, run_case
from robots_controller.study.run_study import ROWS, StudyResults, run_study
from robots_controller.study.study_file import Study, read_study
from robots_core.errors import InvalidInputError, ProgramError, RobotsError
from robots_core.exit_codes import ExitCode

PROGRAM = """local ANGLE, PAUSE = 10, 0.1
ptpJointSpaceAngles(ANGLE, -90, 90, 0, 0, 0)
wait(PAUSE)
call("sub/back")
"""
STUDY = """programs: move.lua
robots: [kuka_kr210_r2700, bello_bot]
overrides: [1, 0.5]
parameters:
  ANGLE: [10, 400]
"""


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp('study')
    (path / 'move.lua').write_text(PROGRAM)
    (path / 'sub').mkdir()
    (path / 'sub' / 'back.lua').write_text('ptpJointSpaceAngles(0, -90, 90, 0, 0, 0)\n')
    (path / 'study.yaml').write_text(STUDY)
    return path


@pytest.fixture(scope='module')
def study(folder: Path) -> Study:
    return read_study(folder / 'study.yaml')


@pytest.fixture(scope='module')
def one_by_one(study: Study) -> list[str]:
    """Rows as texts: NaN is equal to itself there."""
    return [json.dumps(run_case(case)) for case in study.cases()]


def test_cases_are_all_combinations_in_order(study: Study):
    told = [(case.robot, case.override, dict(case.parameters)['ANGLE']) for case in study.cases()]
    assert told == list(itertools.product(['kuka_kr210_r2700', 'bello_bot'], [1.0, 0.5], [10.0, 400.0]))


def test_scene_and_plc_are_those_of_the_header_where_the_study_names_none(tmp_path: Path):
    texts = {'io.yaml': '', 'other.yaml': '', 'p.lua': '-- IO: io.yaml  Scene: scene.yaml\nwait(1)\n'}
    for name, text in {**texts, 'scene.yaml': 'objects: []\n'}.items():
        (tmp_path / name).write_text(text)
    for more, io in (('', 'io.yaml'), ('io: other.yaml\n', 'other.yaml')):
        (tmp_path / 'study.yaml').write_text(f'programs: p.lua\nrobots: ur5e\n{more}')
        (case,) = read_study(tmp_path / 'study.yaml').cases()
        assert {name for name in case.files if name.endswith('.yaml')} == {f'io/{io}', 'scene/scene.yaml'}
    (tmp_path / 'scene.yaml').unlink()
    with pytest.raises(ProgramError, match=r'p\.lua:1: there is no scene '):
        read_study(tmp_path / 'study.yaml').cases()


def test_on_all_cores_as_one_by_one(study: Study, one_by_one: list[str], tmp_path: Path):
    rows = run_study(study, tmp_path, workers=2)
    assert [json.dumps(row) for row in rows] == one_by_one


def test_on_dask_as_one_by_one(study: Study, one_by_one: list[str], tmp_path: Path):
    from distributed import LocalCluster  # noqa: PLC0415  # takes a quarter of a second to load

    # A worker in this process has the robots' modules already; messages go through a socket nevertheless.
    options = {'n_workers': 1, 'threads_per_worker': 1, 'processes': False, 'protocol': 'tcp://'}
    with LocalCluster(**options, dashboard_address=None) as cluster:
        rows = run_study(study, tmp_path, scheduler=cluster.scheduler_address)
    assert [json.dumps(row) for row in rows] == one_by_one


def test_failed_cases_are_rows_with_their_reason(one_by_one: list[str]):
    rows = [json.loads(text) for text in one_by_one]
    assert [row['ok'] for row in rows] == [True, False] + [True, False] + 4 * [False]
    assert rows[1]['line'] == 2
    assert 'move.lua:2: ' in rows[1]['reason']
    assert 'the robot has 7 axes' in rows[4]['reason']
    assert all(set(FIGURES) < set(row) for row in rows)


def test_half_the_override_is_half_the_speed_and_longer(one_by_one: list[str]):
    fast, slow = (json.loads(one_by_one[index]) for index in (0, 2))
    # References are samples: the fastest may lie between two of them.
    assert slow['velocity_use'] == pytest.approx(0.5 * fast['velocity_use'], rel=1e-2)
    assert slow['cycle_time'] > fast['cycle_time'] + 0.1


def test_an_interrupted_study_goes_on(study: Study, one_by_one: list[str], tmp_path: Path):
    cases, results = study.cases(), StudyResults(tmp_path)
    for case, text in itertools.islice(zip(cases, one_by_one, strict=True), 6):
        results.add(case, json.loads(text))
    file = tmp_path / ROWS
    kept = file.read_text()
    file.write_text(kept[:-20])  # killed while it wrote the sixth
    progress: list[tuple[int, int]] = []
    rows = run_study(study, tmp_path, workers=1, on_progress=lambda *told: progress.append(told))
    assert [json.dumps(row) for row in rows] == one_by_one
    assert progress[0] == (5, 8)
    assert progress[-1] == (8, 8)
    before = file.read_text()
    run_study(study, tmp_path, workers=1)
    assert file.read_text() == before


def test_a_changed_program_is_simulated_again(study: Study, folder: Path):
    before = {case.key for case in study.cases()}
    back = folder / 'sub' / 'back.lua'
    text = back.read_text()
    back.write_text(f'{text}-- changed\n')
    try:
        assert before.isdisjoint({case.key for case in study.cases()})
    finally:
        back.write_text(text)
    assert before == {case.key for case in study.cases()}


def test_tables_hold_the_rows(study: Study, one_by_one: list[str], tmp_path: Path):
    cases, results = study.cases(), StudyResults(tmp_path)
    for case, text in zip(cases, one_by_one, strict=True):
        results.add(case, json.loads(text))
    csv_path, parquet_path = results.write(cases)
    for table in (csv.read_csv(csv_path), parquet.read_table(parquet_path)):
        assert table.num_rows == len(cases)
        assert table['override'].to_pylist() == [case.override for case in cases]
        assert table['cycle_time'].to_pylist()[0] == json.loads(one_by_one[0])['cycle_time']


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('robots: ur5e\n', r'study\.yaml:1: programs is missing'),
        ('programs: move.lua\nrobots: []\n', r'study\.yaml:2: robots is missing'),
        ('programs:\n  - move.lua\n  - mov.lua\nrobots: ur5e\n', r'study\.yaml:3: .*mov\.lua'),
        ('programs: move.lua\nrobots: ur5e\noverrides: [1, 2]\n', r'study\.yaml:3: override .2. must be'),
        ('programs: move.lua\nrobots: ur5e\noverrides: [nan]\n', r'study\.yaml:3: override'),
        ('programs: move.lua\nrobots: ur5e\ndrives: idle\n', r'study\.yaml:3: .idle. is no level.*ideal'),
        (
            'programs: move.lua\nrobots: ur5e\nparameters:\n  ANGEL: 1\n',
            r'study\.yaml:4: .*did you mean .ANGLE',
        ),
        ('programs: move.lua\nrobots: ur5e\nscene: x.yaml\n', r'study\.yaml:3: .*x\.yaml'),
        ('programs: move.lua\nrobots: ur5e\nrobot: x\n', r'study\.yaml:3: unknown key .robot.'),
        ('programs: [move.lua\n', r'study\.yaml:2: not YAML'),
    ],
)
def test_mistakes_are_reported_with_their_line(text: str, message: str, folder: Path):
    path = folder / 'wrong' / 'study.yaml'
    path.parent.mkdir(exist_ok=True)
    (path.parent / 'move.lua').write_text(PROGRAM)
    path.write_text(text)
    with pytest.raises(InvalidInputError, match=message):
        read_study(path)


def test_rows_that_are_none_are_reported(tmp_path: Path):
    (tmp_path / ROWS).write_text('{"key": "a", "row": {}}\nnothing\n')
    with pytest.raises(InvalidInputError, match=rf'{ROWS}:2: no result'):
        StudyResults(tmp_path)


def test_no_scheduler_is_reported(study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr('robots_controller.study.case_runners.CONNECT_TIMEOUT', 0.2)
    with pytest.raises(RobotsError, match=r'no Dask scheduler answers at .tcp://127\.0\.0\.1:9'):
        run_study(study, tmp_path, scheduler='tcp://127.0.0.1:9')


@pytest.mark.parametrize('library', ['pyarrow', 'distributed'])
def test_without_its_libraries_a_study_names_what_installs_them(
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    library: str,
):
    monkeypatch.delitem(sys.modules, 'robots_controller.study.run_study')
    monkeypatch.setitem(sys.modules, library, None)
    options = ['-o', str(tmp_path), '--scheduler', 'tcp://127.0.0.1:9']
    assert STUDY_COMMAND.run([str(folder / 'study.yaml'), *options]) == ExitCode.BAD_INPUT
    expected = f'studies need {library}, which is not installed: make study-requirements'
    assert expected in capsys.readouterr().err

"""The examples run, and print what they promise; that of a live cell is in test_cell_client.py."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / 'examples'


def output(name: str, capsys: pytest.CaptureFixture[str]) -> str:
    runpy.run_path(str(EXAMPLES / name))['main']()
    return capsys.readouterr().out


def test_inverse_kinematics_of_a_urdf(capsys: pytest.CaptureFixture[str]) -> None:
    shown = output('inverse_kinematics_of_a_urdf.py', capsys)
    assert '6 axes' in shown
    assert 'off by 0.000 mm' in shown


def test_own_planner(capsys: pytest.CaptureFixture[str]) -> None:
    assert 'all limits kept' in output('own_planner.py', capsys)


def test_time_optimal_line(capsys: pytest.CaptureFixture[str]) -> None:
    first, second = output('time_optimal_line.py', capsys).splitlines()
    assert first.startswith('LinearCartesianDynamicProgramming')
    assert second.startswith('LinearCartesianLimited')


def test_program_on_robots(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / 'speeds.png'
    robots = ['kuka_kr210_r2700', 'kuka_kr210_r3100']
    runpy.run_path(str(EXAMPLES / 'program_on_robots.py'))['main'](
        ['--robots', *robots, '--picture', str(picture)]
    )
    *lines, last = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == robots
    assert all('4 motions, FINISHED' in line for line in lines)
    assert last == str(picture)
    assert picture.read_bytes().startswith(b'\x89PNG')


def outputs(notebook: dict[str, Any], kind: str) -> list[Any]:
    """What is stored of a kind in the cells of a notebook."""
    return [
        one for cell in notebook['cells'] for one in cell.get('outputs', ()) if one['output_type'] == kind
    ]


def test_the_notebook_runs_and_its_stored_texts_are_those_that_it_prints() -> None:
    path = EXAMPLES / 'robot_and_path.ipynb'
    stored = json.loads(path.read_text())
    run = runpy.run_path(str(ROOT / 'docs' / 'run_notebook.py'))['run_notebook'](path)
    assert outputs(run, 'stream') == outputs(stored, 'stream')
    assert len(outputs(run, 'display_data')) == len(outputs(stored, 'display_data')) == 4

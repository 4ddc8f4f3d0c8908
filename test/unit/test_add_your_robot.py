"""The page "Add your robot", followed literally."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import textwrap
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# A fenced block, with the text before it back to the last one.
BLOCK = re.compile(
    r'(?P<before>(?:(?!```).)*?)^ *```(?P<language>\w+)\n(?P<text>.*?)^ *```$', re.DOTALL | re.MULTILINE
)
FILE = re.compile(r'`(my_robot/[^`]+)`')


@dataclass(frozen=True)
class Step:
    """A fenced block: a command, or the contents of a file."""

    language: str
    text: str
    file: str | None


def read_steps() -> list[Step]:
    page = (ROOT / 'docs' / 'how_to' / 'add_your_robot.md').read_text()
    steps = []
    for match in BLOCK.finditer(page):
        language, text = match['language'], textwrap.dedent(match['text'])
        files = FILE.findall(match['before'])
        steps.append(Step(language, text, None if language == 'bash' else files[-1]))
    return steps


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A copy of what the steps touch, with this Python as its `.venv`."""
    shutil.copytree(ROOT / 'robots_models' / 'template_robot', tmp_path / 'robots_models' / 'template_robot')
    for name in ('test', 'pyproject.toml'):
        (tmp_path / name).symlink_to(ROOT / name)
    commands = tmp_path / '.venv' / 'bin'
    commands.mkdir(parents=True)
    for name, words in {'python': '', 'pip': '-m pip'}.items():
        command = commands / name
        command.write_text(f'#!/bin/sh\nexec {sys.executable} {words} "$@"\n')
        command.chmod(0o755)
    return tmp_path


def test_steps_lead_to_a_robot_that_keeps_the_contract(workspace: Path):
    site = workspace / 'site'
    environment = os.environ | {
        'PYTHONPATH': os.pathsep.join([str(site), *filter(None, [os.environ.get('PYTHONPATH')])]),
        # Beside this Python's own packages, and from what is there: tests change and download nothing.
        'PIP_TARGET': str(site),
        'PIP_UPGRADE': '1',  # the robot is installed twice
        'PIP_NO_DEPS': '1',
        'PIP_NO_BUILD_ISOLATION': '0',  # pip reads "no" into 0
        'PIP_DISABLE_PIP_VERSION_CHECK': '1',
        'PYTHONDONTWRITEBYTECODE': '1',
    }
    steps = read_steps()
    assert [step.language for step in steps] == ['bash', 'yaml', 'python', 'bash', 'bash', 'bash']
    for step in steps:
        if step.file is not None:
            assert (workspace / step.file).is_file(), f'step for {step.file}: the template has no such file'
            (workspace / step.file).write_text(step.text)
            continue
        done = subprocess.run(
            ['bash', '-euc', step.text],
            cwd=workspace,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f'{step.text}\n{done.stdout}\n{done.stderr}'
    assert re.search(r'\d+ passed', done.stdout)
    script = (
        'from robots_core import load_robot_model as load\n'
        'robot = load("my_robot")\n'
        'print(robot.name, *robot.axes_data.names, *robot.axes_data.acceleration)\n'
        'print(robot.structural_data.reach)'
    )
    loaded = subprocess.run(
        [sys.executable, '-c', script],
        env=environment,
        cwd=workspace,
        capture_output=True,
        text=True,
        check=True,
    )
    assert loaded.stdout.split() == ['my_robot', 'J1', 'J2', 'J3', '4.0', '4.0', '6.0', '0.8']
    left = [file.name for file in (workspace / 'my_robot').rglob('*') if 'emplate' in file.name]
    assert left == []

"""The commands of README and docs do what the pages say, in a folder with the files that a page writes."""

from __future__ import annotations

import re
import shlex
from importlib.metadata import entry_points
from itertools import chain
from pathlib import Path
from typing import Final

import pytest

from robots_controller.commands.command_table import ABOUT_ROBOTS, TOOLS
from robots_core.exit_codes import ExitCode

ROOT: Final = Path(__file__).parents[2]
PAGES: Final = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').rglob('*.md'))]
COMMANDS: Final = {command.name: command for command in (*ABOUT_ROBOTS, *TOOLS)}
BELOW_ROBOTS: Final = {command.name for command in ABOUT_ROBOTS}
NODES: Final = {'cell', 'replay_bag'}
"""Commands that start nodes of ROS: test/cell and test/node run them."""
INSTALL_AND_BUILD: Final = {
    *('make', 'colcon', 'pip', '.venv/bin/pip', 'python', 'python3', '.venv/bin/python'),
    *('mkdir', 'cp', 'mv', 'sed'),
}
SHELL_OF_ROS: Final = {'ros2', 'source', 'export'}
EXECUTABLES: Final = {
    point.name for point in entry_points(group='console_scripts') if point.value.startswith('robots_')
}
THE_READERS: Final = (
    '/path/to',
    'my_drive',
    'expected/bag',
    'before/bag',
    'my_cell/square.lua',
    'my_cell/touch.points.yaml',
    'my_cell/frames.yaml',
    'welding_study',
    'welding.html',
)
"""Arguments that name what the reader has."""
LONG: Final = 'check_program programs/press_tending.lua --robot'
"""Walks with 32 combinations of inputs, for half a minute."""


def lines(page: Path) -> list[str]:
    """The commands of a page, without comments."""
    text = '\n'.join(re.findall(r'```bash\n(.*?)```', page.read_text(), re.DOTALL))
    text = re.sub(r'python -c "\n.*?"\n', '', text.replace('\\\n', ' ') + '\n', flags=re.DOTALL)
    found = (re.sub(r'\s#.*', '', line).strip() for line in text.splitlines())
    return [line for line in found if line and not line.startswith(('#', '"'))]


def words_of(line: str) -> list[str]:
    """Words of a command up to a pipe or a redirection, without what stands before its name."""
    line = re.split(r' [|>] | 2>', line.removeprefix('ros2 run robots_controller '))[0]
    words = shlex.split(line)
    return words[1:] if words[0] == 'robots' and words[1] in COMMANDS else words


def ours(page: Path) -> list[list[str]]:
    """Commands of a page that start no nodes, and need no more than what the page writes."""
    every = [words_of(line) for line in lines(page)]
    return [
        words
        for words in every
        if words[0] in COMMANDS
        and words[0] not in NODES
        and not shlex.join(words).startswith(LONG)
        and not any(part in word for word in words for part in THE_READERS)
    ]


def write_files(page: Path) -> None:
    """Write the files that a page has its reader write: code below a line that names a file."""
    pattern = r'`([\w/]+\.(?:lua|yaml))`[^`]*?\n\n```(?:lua|yaml)\n(.*?)```'
    for name, text in re.findall(pattern, page.read_text(), re.DOTALL):
        path = Path(name)
        if '/' in name:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)


@pytest.mark.parametrize('page', [page for page in PAGES if ours(page)], ids=lambda page: page.stem)
def test_the_commands_of_a_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ('programs', 'examples'):
        Path(folder).symlink_to(ROOT / folder)
    Path('out').mkdir()  # as `make demo` has left it
    write_files(page)
    for words in ours(page):
        name, *arguments = words
        found = [sorted(map(str, Path().glob(word))) if '*' in word else [word] for word in arguments]
        code, said = COMMANDS[name].run(list(chain(*found))), capsys.readouterr()
        # What `check_program` finds, the page says.
        expected = (ExitCode.OK, ExitCode.FAILED) if name == 'check_program' else (ExitCode.OK,)
        assert code in expected, f'{shlex.join(words)}\n{said}'


def test_every_command_of_a_page_is_one_that_is_run_or_known() -> None:
    for page in PAGES:
        for line in lines(page):
            words = words_of(line)
            known = {*COMMANDS, *EXECUTABLES, *INSTALL_AND_BUILD, *SHELL_OF_ROS}
            assert words[0] in known or '=' in words[0], f'{page.name}: {line}'
            assert words[0] not in BELOW_ROBOTS or line.startswith('robots '), f'{page.name}: {line}'

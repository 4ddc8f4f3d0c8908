"""What the README and the pages of the documentation say is so."""

from __future__ import annotations

import argparse
import inspect
import re
from dataclasses import fields
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from textwrap import dedent

import pytest
import yaml

from robots_controller.commands.error_catalogue import describe_error, error_catalogue
from robots_controller.commands.robots import COMMANDS
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.live_cell import describe_nodes
from robots_controller.program_check.program_check import check_program
from robots_core import available_robot_models, load_robot_model
from robots_core.cell_interface.topic_qos import PROFILES, TOPIC_QOS, topic_qos
from robots_core.exit_codes import ExitCode
from robots_planning import MotionSettings
from robots_planning.motion_kinds import MOTION_KINDS

ROOT = Path(__file__).parents[2]
README = ROOT / 'README.md'
DOCS = ROOT / 'docs'
INDEX = DOCS / 'index.md'
CONTRIBUTING = ROOT / 'CONTRIBUTING.md'
PACKAGE_PAGES = sorted(ROOT.glob('robots_*/README.md'))  # which are no pages of the site
PAGES = [
    *(ROOT / name for name in ('README.md', 'CONTRIBUTING.md', 'SECURITY.md', 'CHANGELOG.md')),
    *PACKAGE_PAGES,
    *sorted(DOCS.rglob('*.md')),
]
TUTORIALS = sorted((DOCS / 'tutorials').glob('*.md'))
API = sorted((DOCS / 'reference').glob('python_*.md'))
EVERYTHING = '\n'.join(page.read_text() for page in PAGES)


def section(page: Path, title: str) -> str:
    """The text below a heading of a page, up to the next one of the same or a higher level."""
    text = page.read_text()
    level = re.search(rf'^(#+) {re.escape(title)}$', text, re.MULTILINE)
    assert level, f'no heading {title!r} in {page.name}'
    rest = text[level.end() :]
    following = re.search(rf'^#{{1,{len(level.group(1))}}} ', rest, re.MULTILINE)
    return rest[: following.start()] if following else rest


def table(page: Path, title: str) -> list[list[str]]:
    """Rows of the first table of a section, cells stripped, without the heading."""
    found = re.search(r'(?:^\|.*\n)+', section(page, title), re.MULTILINE)
    assert found, f'no table below {title!r}'
    rows = [
        [cell.strip() for cell in re.split(r'(?<!\\)\|', line)[1:-1]] for line in found.group().splitlines()
    ]
    return rows[2:]


def blocks(page: Path, language: str) -> list[str]:
    """The code blocks of a page in one language, without their indentation in lists."""
    found = re.findall(rf'^( *)```{language}\n(.*?)^ *```', page.read_text(), re.MULTILINE | re.DOTALL)
    return [dedent(text) for _, text in found]


def names(cell: str) -> list[str]:
    return re.findall(r'`([^`]+)`', cell)


def test_the_robots_are_those_that_are_installed() -> None:
    listed = {names(row[0])[0]: int(row[1]) for row in table(README, 'The robots')}
    ours = [
        point.name
        for point in entry_points(group='robots_core.robot_models')
        if point.value.startswith('robots_models.')
    ]
    assert set(listed) == set(ours) <= set(available_robot_models())
    for name, axes in listed.items():
        assert load_robot_model(name).num_axes == axes, name


def test_the_nodes_are_the_executables() -> None:
    listed = {
        (row[1], name)
        for row in table(DOCS / 'reference' / 'nodes.md', 'Nodes and executables')
        for name in names(row[0])
    }
    packages = ('robots_core', 'robots_planning', 'robots_controller')
    installed = {
        (point.value.split('.')[0], point.name)
        for point in entry_points(group='console_scripts')
        if point.value.startswith(packages)
    }
    assert listed == installed


def test_the_commands_and_exit_codes_are_those_of_the_code() -> None:
    page = DOCS / 'reference' / 'commands.md'
    assert {names(row[0])[0].removeprefix('robots '): row[1] for row in table(page, 'Commands')} == {
        command.name: command.what for command in COMMANDS.values()
    }
    assert {int(code) for code, _ in table(page, 'Exit codes')} == set(ExitCode)


def test_the_errors_are_those_of_the_code() -> None:
    rows = table(DOCS / 'reference' / 'errors.md', 'Errors')
    assert {row[0]: (names(row[1])[0], row[2], row[3]) for row in rows} == {
        code: (kind.__name__, describe_error(kind), kind.remedy) for code, kind in error_catalogue().items()
    }


def test_the_names_of_the_paper_lead_to_something() -> None:
    rows = table(DOCS / 'explanation' / 'from_the_paper.md', 'From the paper to the code')
    assert len(rows) > 15
    for row in rows:
        for name in names(row[1]):
            if '/' in name:
                assert (ROOT / name).is_file(), name
            else:
                module, _, attribute = name.rpartition('.')
                assert hasattr(import_module(module), attribute), name


def test_the_lua_functions_are_those_of_the_interpreter() -> None:
    listed = {
        names(row[0])[0]: (row[1], row[2])
        for row in table(DOCS / 'reference' / 'robot_programs.md', 'Robot programs')
    }
    assert listed == {f.signature: (f.doc, f.result or '-') for f in LUA_FUNCTIONS.values()}


@pytest.mark.parametrize('name', describe_nodes.PAGES)
def test_rows_of_the_reference_are_those_that_the_command_writes(name: str) -> None:
    page = (DOCS / name).read_text()
    assert describe_nodes.PAGES[name](page) == page


def test_rows_of_the_reference_are_renewed_in_their_places(tmp_path: Path) -> None:
    for name in describe_nodes.PAGES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(
            re.sub(r'line|Cartesian|`collision_node`', 'x', (DOCS / name).read_text())
        )
    describe_nodes.write_pages(tmp_path)
    renewed = (tmp_path / 'reference' / 'robot_programs.md').read_text()
    assert '| `circCartesianSpace(via, target, [options])` | Moves the tool on an arc' in renewed
    assert '| `ptpcartesian` | geometry_msgs/PoseStamped | COMMAND | anyone | command: ' in (
        (tmp_path / 'reference' / 'topics.md').read_text()
    )
    assert '| `collision_node` | robots_core | ' in (tmp_path / 'reference' / 'nodes.md').read_text()


def test_the_topics_of_motion_commands_are_those_of_the_table() -> None:
    listed = {
        topic: row[1]
        for row in table(DOCS / 'reference' / 'topics.md', 'Topics')
        if 'command:' in row[4]
        for topic in names(row[0])
    }
    assert listed == {kind.topic: kind.message_type.replace('/msg', '') for kind in MOTION_KINDS}


def test_the_quality_of_service_is_that_of_the_table_in_code() -> None:
    page = DOCS / 'reference' / 'topics.md'
    of_others = {'rosout', 'parameter_events'}
    listed = set()
    for row in table(page, 'Topics'):
        topics = names(row[0])
        assert row[2] == ', '.join(dict.fromkeys(topic_qos(topic).text for topic in topics)), topics
        listed |= {topic.rpartition('/')[2] for topic in topics}
    assert listed == TOPIC_QOS.keys() - of_others
    for one in PROFILES:
        ways = 'reliable' if one.reliable else 'best effort', 'transient local' if one.latched else 'volatile'
        assert f'| {one.name} | {one.depth} | {" | ".join(ways)} | {one.what} |' in section(page, 'Topics')


def test_the_motion_settings_are_those_of_the_planner() -> None:
    listed = {
        names(row[0])[0]: row[1] for row in table(DOCS / 'reference' / 'planners.md', 'Motion settings')
    }
    said = {'': 'nearest', False: 'false', 'tool': 'tool0', 'base': "the robot's base", 'payload': 'nothing'}
    said['hold'] = 'what the arm can'
    for field in fields(MotionSettings):
        number = isinstance(field.default, int | float) and not isinstance(field.default, bool)
        expected = f'{field.default:g}' if number else said.get(field.name) or said.get(field.default)
        assert listed.pop(field.name) == (expected or field.default)
    assert not listed


def test_the_ten_lines_run(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r'```python\n(.*?)```', section(README, 'Ten lines'), re.DOTALL)
    exec(compile(code, 'README.md', 'exec'), {})  # noqa: S102  # our own README
    out = capsys.readouterr().out
    assert out.count('all limits kept') == 2


@pytest.mark.parametrize('page', TUTORIALS, ids=lambda page: page.stem)
def test_the_python_of_tutorials_runs(page: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for code in blocks(page, 'python'):
        exec(compile(code, page.name, 'exec'), {'__name__': __name__})  # noqa: S102  # our own pages
    if page.stem == 'from_moveit':
        assert capsys.readouterr().out.count('all limits kept') == 2


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.stem)
def test_the_robot_programs_of_pages_are_right(page: Path, tmp_path: Path) -> None:
    program = tmp_path / 'program.lua'
    for text in blocks(page, 'yaml'):
        if text.startswith('tools:'):
            (tmp_path / 'frames.yaml').write_text(text)
    for code in blocks(page, 'lua'):
        program.write_text(code)
        assert not check_program(program, Sizes(6, 32, 8)), code


@pytest.mark.parametrize('page', PAGES, ids=lambda page: page.stem)
def test_the_files_in_pages_are_yaml(page: Path) -> None:
    for text in blocks(page, 'yaml'):
        assert isinstance(yaml.safe_load(text), dict), text


def help_of(parser: argparse.ArgumentParser) -> str:
    """Of a command, and of those below it."""
    texts = [parser.format_help()]
    for action in parser._actions:
        if isinstance(action.choices, dict):
            texts += [help_of(one) for one in action.choices.values()]
    return '\n'.join(texts)


def test_the_commands_have_the_options_that_pages_give_them() -> None:
    given: dict[str, set[str]] = {}
    for line in (
        '\n'.join(text for page in PAGES for text in blocks(page, 'bash')).replace('\\\n', ' ').splitlines()
    ):
        text = line.removeprefix('ros2 run robots_controller ').removeprefix('robots ')
        name, *words = text.partition(' #')[0].partition(' | ')[0].split() or ['']
        if name in COMMANDS:
            ours = words[: words.index('--ros-args')] if '--ros-args' in words else words
            given.setdefault(name, set()).update(word for word in ours if word.startswith('-'))
    assert {'cell', 'simulate', 'check_program', 'report', 'study', 'check_bag', 'check'} <= set(given)
    for name, options in given.items():
        described = help_of(COMMANDS[name].parser())
        assert not [option for option in options if not re.search(rf'{option}\b', described)], name


@pytest.mark.parametrize('page', API, ids=lambda page: page.stem)
def test_the_python_reference_has_every_public_name(page: Path) -> None:
    (title,) = re.findall(r'^# (`.*)$', page.read_text(), re.MULTILINE)
    (module,) = names(title)
    listed = {names(row[0])[0]: row[1] for row in table(page, title)}
    assert listed.keys() >= set(getattr(import_module(module), '__all__', ()))
    for name, text in listed.items():
        where, _, attribute = f'{module}.{name}'.rpartition('.')
        documented = inspect.getdoc(getattr(import_module(where), attribute)) or ''
        assert text == documented.partition('\n\n')[0].replace('\n', ' '), name


def test_what_pages_link_to_exists() -> None:
    for page in PAGES:
        for target, heading in re.findall(r'\]\(([^)#\s]*)(?:#([^)]*))?\)', page.read_text()):
            if '://' in target:
                continue
            linked = page.parent / target if target else page
            assert linked.exists(), f'{page.name}: {target}'
            titles = re.findall(r'^#+ (.*)$', linked.read_text(), re.MULTILINE) if heading else []
            assert not heading or heading in map(anchor, titles), f'{page.name}: {target}#{heading}'


def anchor(title: str) -> str:
    """The name that a heading has in links."""
    return re.sub(r'[^\w\- ]', '', title.lower()).replace(' ', '-')


def test_the_index_leads_to_every_page_and_example() -> None:
    text = INDEX.read_text()
    listed = re.findall(r'\]\(([^)]+)\)', text[text.index('## ') :])
    assert len(listed) == len(set(listed))
    pages = set(PAGES) - {INDEX, *PACKAGE_PAGES}
    examples = {path for path in (ROOT / 'examples').glob('*.py') if '__main__' in path.read_text()}
    examples |= set((ROOT / 'examples').glob('*.ipynb'))
    assert {(DOCS / target).resolve() for target in listed} == pages | examples


def test_the_readme_is_short_and_leads_to_the_index() -> None:
    text = README.read_text()
    assert '](docs/index.md)' in text
    assert text.count('\n') <= 200


def test_the_programs_exist() -> None:
    for path in re.findall(r'programs/\w+\.lua', EVERYTHING):
        assert (ROOT / path).is_file(), path


def test_the_make_targets_exist() -> None:
    makefile = (ROOT / 'Makefile').read_text()
    targets = set(re.findall(r'^([a-z][a-z-]*):', makefile, re.MULTILINE))
    code = '\n'.join(
        re.findall(r'```bash\n(.*?)```', EVERYTHING, re.DOTALL) + re.findall(r'`([^`\n]+)`', EVERYTHING)
    )
    named = set(re.findall(r'\bmake ([a-z][a-z-]*)', code))
    assert {'demo', 'test', 'build'} <= named <= targets


def test_the_contributors_page_names_files_that_exist() -> None:
    files = {path.as_posix() for path in ROOT.glob('robots_*/**/*.py')} | {
        path.as_posix() for path in ROOT.glob('test/**/*.py')
    }
    for name in names(CONTRIBUTING.read_text()):
        if name.endswith('.py'):
            assert any(file.endswith(f'/{name}') for file in files), name

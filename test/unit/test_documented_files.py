"""The pages about files agree with the readers: keys, defaults, bounds and refusals, in the examples."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import pytest
import trimesh
import yaml

from robots_controller.cell.contact_setup import read_contact
from robots_controller.cell.guide_recording import GUIDES
from robots_controller.io.io_map import read_io_map
from robots_controller.io.plc_script import read_plc_script
from robots_controller.program.files.cell_frames import read_frames
from robots_controller.program.files.persistent_values import PersistentValues
from robots_controller.program.files.program_header import HEADER_FILES, read_program_header
from robots_controller.program.files.taught_points import read_points
from robots_controller.recording.bag_tolerances import read_tolerances
from robots_controller.study.run_case import FIGURES
from robots_controller.study.study_file import read_study
from robots_core.blocks import read_scene
from robots_core.blocks.floating_base.orbit import read_orbit
from robots_core.blocks.terramechanics.soil import Soil
from robots_core.errors import RobotsError
from robots_core.files.yaml_section import YamlSection
from robots_core.robot_model.allowed_pairs import REASONS
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.urdf.urdf_chain import EXTRA_KEYS, read_urdf_chain

from .test_documentation import ROOT, blocks, names, section, table

PAGES: Final = ROOT / 'docs' / 'reference'
FILES, SCENE, IO, OTHER = (
    PAGES / f'{name}.md' for name in ('files', 'scene_file', 'io_files', 'contact_and_orbit_files')
)
URDF: Final = ROOT / 'robots_models' / 'template_robot' / 'template_robot' / 'robot.urdf'
Read = Callable[[Path], Any]
Place = tuple[str | int, ...]


def read_limits(path: Path) -> AxesData:
    return read_urdf_chain(URDF.read_text(), joint_limits=path).axes_data


class Described(NamedTuple):
    """A table of keys: its heading, and where such a mapping stands in the example; * stands for any."""

    heading: str
    places: tuple[str, ...]


@dataclass(frozen=True)
class Format:
    """A file format: its page and example, its reader, its tables, and its table of refusals."""

    page: Path
    heading: str
    read: Read
    tables: tuple[Described, ...]
    refusals: str = ''

    @property
    def example(self) -> str:
        found = re.search(r'```yaml\n(.*?)```', section(self.page, self.heading), re.DOTALL)
        assert found
        return found[1]


def format_of(page: Path, heading: str, read: Read, refusals: str = '', **tables: Sequence[str]) -> Format:
    headings = {title: title.replace('I_O', 'I/O').replace('_', ' ') for title in tables}
    described = (Described(headings[title], tuple(places)) for title, places in tables.items())
    return Format(page, heading, read, tuple(described), refusals)


FORMATS: Final = {
    'scene': format_of(
        *(SCENE, 'Example', read_scene, 'Refused'),
        Sections=[''],
        Objects=['objects.*', 'attached.*'],
        Boxes=['objects.*.box', 'zones.*.box'],
        Spheres=['objects.*.sphere'],
        Cylinders_and_capsules=['objects.*.cylinder', 'attached.*.capsule'],
        Meshes=['objects.*.mesh'],
        Poses=['objects.*.pose', 'attached.*.pose', 'zones.*.pose'],
        Zones=['zones.*'],
        Planes=['zones.*.plane'],
    ),
    'io_map': format_of(
        *(IO, 'I/O map', read_io_map, 'What an I/O map refuses'),
        Sections_of_an_I_O_map=[''],
        Entries=['inputs.*', 'outputs.*'],
        Quality_of_service=['inputs.*.qos'],
    ),
    'plc': format_of(
        *(IO, 'Scripted PLC', read_plc_script, 'What a scripted PLC refuses'),
        Sections_of_a_scripted_PLC=[''],
        Rules=['rules.*'],
    ),
    'contact': format_of(
        *(OTHER, 'Contact file', read_contact, 'What a contact file refuses'),
        Sections_of_a_contact_file=[''],
        Wheel=['wheel'],
        Soil=['soil'],
        Bed=['bed'],
        Force_control=['force_control'],
        Outputs=['outputs'],
    ),
    'orbit': format_of(
        *(OTHER, 'Orbit file', read_orbit, 'What an orbit file refuses'),
        Sections_of_an_orbit_file=[''],
        Target=['target'],
        Gripper=['gripper'],
        Wheels=['wheels'],
        Approach=['approach'],
    ),
    'frames': format_of(
        *(FILES, 'Tools and bases', read_frames, 'What a frames file refuses'),
        Sections_of_a_frames_file=[''],
        Tools=['tools.*'],
        Bases=['bases.*'],
    ),
    'points': format_of(FILES, 'Taught points', partial(read_points, num_axes=6), Taught_points=['points.*']),
    'limits': format_of(FILES, 'Joint limits', read_limits, Joint_limits=['joint_limits.*']),
    'study': format_of(FILES, 'Study', read_study, Study=['']),
    'tolerances': format_of(FILES, 'Tolerances', read_tolerances, Tolerances=['', 'default', 'topics.*']),
}


def rows(found: Format, described: Described) -> list[list[str]]:
    """Rows (keys, default, valid, what) of all tables of keys below a heading."""
    lines = re.split(r'^#+ ', section(found.page, described.heading), maxsplit=1, flags=re.MULTILINE)[0]
    tables = re.findall(r'^\| key.*\n\|[-|]+\n((?:\|.*\n)+)', lines, re.MULTILINE)
    cells = [re.split(r'(?<!\\)\|', line)[1:-1] for text in tables for line in text.splitlines()]
    found_rows = [[cell.strip() for cell in row] for row in cells]
    return [row if len(row) == 4 else [*row[:2], '', row[2]] for row in found_rows]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """What the examples name stands there."""
    (tmp_path / 'milling.lua').write_text('local SPEED = 0.2\n')
    for name in ('cell', 'plc'):
        (tmp_path / f'{name}.yaml').write_text('{}')
    trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / 'part.stl')
    return tmp_path


def read(found: Format, folder: Path, data: Any) -> str:
    """What the reader makes of data, in one line so that no line number depends on it."""
    path = folder / 'example.yaml'
    path.write_text(yaml.safe_dump(data, default_flow_style=True, width=1_000_000, sort_keys=False))
    return shown(found.read(path))


def shown(value: Any) -> str:
    """Everything in a result, as text."""
    match value:
        case np.ndarray():
            return repr(value.tolist())
        case int() | float() if not isinstance(value, bool):
            return repr(float(value))
        case Mapping():
            return repr({str(key): shown(item) for key, item in value.items()})
        case tuple() | list() | frozenset():
            return repr([shown(item) for item in value])
    attributes = getattr(value, '__dataclass_fields__', {})
    return repr({name: shown(getattr(value, name)) for name in attributes} if attributes else value)


def places(data: Any, pattern: str) -> Iterator[Place]:
    """Where mappings stand that a pattern names."""
    found: list[Place] = [()]
    for step in filter(None, pattern.split('.')):
        longer: list[Place] = []
        for place in found:
            item = at(data, place)
            keys = range(len(item)) if isinstance(item, list) else item
            longer += [(*place, key) for key in keys if step in ('*', key)]
        found = longer
    return iter(found)


def at(data: Any, place: Place) -> Any:
    for step in place:
        data = data[step]
    return data


def changed(data: Any, place: Place, key: str, *value: Any) -> Any:
    """A copy with another value of a key, or without it."""
    copied = copy.deepcopy(data)
    if value:
        at(copied, place)[key] = value[0]
    else:
        del at(copied, place)[key]
    return copied


def uses(data: Any, described: Described, key: str) -> list[list[Place]]:
    """The mappings of the example that have a key, by the patterns of their places."""
    groups = [
        [place for place in places(data, pattern) if key in at(data, place)] for pattern in described.places
    ]
    return [group for group in groups if group]


TABLES: Final = [
    pytest.param(found, described, id=f'{name}-{described.heading}')
    for name, found in FORMATS.items()
    for described in found.tables
]


@pytest.mark.parametrize(('found', 'described'), TABLES)
def test_a_key_is_required_exactly_where_its_table_says_so(
    found: Format, described: Described, folder: Path
) -> None:
    data = yaml.safe_load(found.example)
    read(found, folder, data)
    for keys, default, _, _ in rows(found, described):
        for key in names(keys):
            refused = []
            stands = [place for group in uses(data, described, key) for place in group]
            assert stands, f'{key} is not in the example'
            if default.startswith('required for'):
                continue
            for place in stands:
                try:
                    read(found, folder, changed(data, place, key))
                    refused.append(False)
                except RobotsError:
                    refused.append(True)
            required = default.startswith(('required', 'one of these'))
            assert all(refused) == required, f'{key}: {default}'


@pytest.mark.parametrize(('found', 'described'), TABLES)
def test_a_default_is_what_a_missing_key_stands_for(
    found: Format, described: Described, folder: Path
) -> None:
    data = yaml.safe_load(found.example)
    for keys, default, _, _ in rows(found, described):
        value = yaml.safe_load(default.strip('`')) if re.fullmatch(r'`[^`]*`|[\d.]+', default) else None
        for key in names(keys) if value is not None else ():
            for place in (group[0] for group in uses(data, described, key)):
                without = changed(data, place, key)
                with_default = changed(data, place, key, value)
                assert read(found, folder, without) == read(found, folder, with_default), key


def outside(valid: str) -> list[Any]:
    """Values that a cell `valid` excludes, as far as it is a range or a list of words."""
    number = r'([\d.e+-]+)'
    if match := re.fullmatch(rf'{number} to {number}.*', valid):
        low, high = float(match[1]), float(match[2])
        return [low - max(1e-7, 1e-3 * abs(low)), 1.001 * high + 0.001]
    if match := re.match(rf'at least {number}', valid):
        return [float(match[1]) - 1e-3]
    if match := re.match(rf'above {number}', valid):
        return [float(match[1])]
    if re.fullmatch(r'`\w+`((, | or )`\w+`)+', valid):
        return ['something else']
    if match := re.match(r'(\d+) numbers', valid):
        return [[0.1] * (int(match[1]) + 1), ['a'] * int(match[1]), [float('nan')] * int(match[1])]
    return []


@pytest.mark.parametrize(('found', 'described'), TABLES)
def test_values_outside_of_the_documented_range_are_refused(
    found: Format, described: Described, folder: Path
) -> None:
    data = yaml.safe_load(found.example)
    for keys, _, valid, _ in rows(found, described):
        for key in names(keys):
            for place in (group[0] for group in uses(data, described, key)):
                if isinstance(at(data, place)[key], dict):  # then `valid` names the keys below
                    continue
                for value in outside(valid):
                    with pytest.raises(RobotsError):
                        print(key, value, read(found, folder, changed(data, place, key, value)))


@pytest.mark.parametrize('name', [name for name, found in FORMATS.items() if found.refusals])
def test_what_a_page_says_is_refused_is_refused_with_that_message(name: str, folder: Path) -> None:
    found = FORMATS[name]
    path = folder / 'example.yaml'
    for before, after, message in table(found.page, found.refusals):
        (old,), (new,) = names(before), names(after)
        assert old in found.example, old
        path.write_text(found.example.replace(old, new, 1))
        with pytest.raises(RobotsError, match=re.escape(message)) as caught:
            found.read(path)
        assert re.search(r'example\.yaml:\d+: ', str(caught.value)) or 'file' in message


@pytest.mark.parametrize('name', [*FORMATS])
def test_the_tables_have_all_keys_that_the_reader_reads(
    name: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = FORMATS[name]
    asked: dict[tuple[str, ...], set[str]] = {}
    finish = YamlSection.finish

    def recorded(self: YamlSection, valid: Sequence[str] = ()) -> None:
        asked.setdefault(self.keys, set()).update(self._read, valid)
        finish(self, valid)

    monkeypatch.setattr(YamlSection, 'finish', recorded)
    path = folder / 'example.yaml'
    path.write_text(yaml.safe_dump(yaml.safe_load(found.example), sort_keys=False))
    found.read(path)
    data = yaml.safe_load(found.example)
    for described in found.tables:
        stand = [at(data, place) for pattern in described.places for place in places(data, pattern)]
        read_keys = set().union(*(asked.get(tuple(map(str, item)), set()) for item in stand))
        listed = {key for row in rows(found, described) for key in names(row[0])}
        assert not read_keys or listed == read_keys, described.heading


def test_the_keys_that_are_read_by_other_means_are_in_their_tables() -> None:
    def listed(found: Format, heading: str) -> list[str]:
        (described,) = [table for table in found.tables if table.heading == heading]
        return [key for row in rows(found, described) for key in names(row[0])]

    assert listed(FORMATS['limits'], 'Joint limits') == [*EXTRA_KEYS]
    assert listed(FORMATS['contact'], 'Soil') == [field.name for field in fields(Soil)]
    assert [names(row[0])[0] for row in table(FILES, 'Allowed pairs')] == [*REASONS]
    assert [row[1] for row in table(FILES, 'Allowed pairs')] == [*REASONS.values()]
    assert [names(row[0])[0] for row in table(FILES, 'Results of a study')] == [*FIGURES]
    assert [tuple(names(row[1])) for row in table(FILES, 'Recordings that guide')] == [*GUIDES.values()]
    header = [names(row[0])[0] for row in table(FILES, 'Program header')]
    assert [key.lower() for key in header] == ['robot', *HEADER_FILES]


def test_the_header_in_the_page_is_read(tmp_path: Path) -> None:
    (program,) = blocks(FILES, 'lua')
    path = tmp_path / 'program.lua'
    path.write_text(program)
    header = read_program_header(path)
    assert header.robot == 'kuka_kr210_r2700'
    assert header.scene == str(tmp_path / 'scenes' / 'car_frame.yaml')
    assert header.io == str(tmp_path / 'io' / 'press_tending.yaml')


def test_the_persistent_values_in_the_page_are_read(tmp_path: Path) -> None:
    (text,) = re.findall(r'```yaml\n(values:.*?)```', FILES.read_text(), re.DOTALL)
    path = tmp_path / 'program.values.yaml'
    path.write_text(text)
    values = PersistentValues(path, kept=True)
    assert (values.get('parts'), values.get('offset')) == (42, (0.001, 0.0, -0.002))
    path.write_text(text.replace('42', '.nan'))
    with pytest.raises(RobotsError, match='valid are numbers, texts'):
        PersistentValues(path, kept=True).get('parts')

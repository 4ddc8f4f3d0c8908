"""YAML files whose mistakes are reported with file and line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import YamlSection, parse_yaml, read_yaml

TEXT = """
name: press
speed: 1.5
count: 3
on: true
below:
  deep: 1
rows:
  - {a: 1}
  - {a: 2}
empty:
"""


def test_values_are_read_with_their_types():
    section = parse_yaml(TEXT, 'x.yaml')
    assert section.text('name') == 'press'
    assert section.number('speed') == 1.5
    assert section.whole('count', low=1, high=3) == 3
    assert section.switch('on')
    below = section.section('below')
    assert below is not None
    assert below.whole('deep', low=0, high=1) == 1
    assert [row.whole('a', low=1, high=2) for row in section.sections('rows')] == [1, 2]
    assert list(section.sections('empty')) == []
    assert section.text('missing', 'default') == 'default'
    section.finish()


@pytest.mark.parametrize(
    ('read', 'line', 'message'),
    [
        (lambda s: s.number('name'), 2, "name is 'press'; valid is a finite number"),
        (lambda s: s.number('speed', high=1.0), 3, 'speed is 1.5; valid is a number in'),
        (lambda s: s.number('count', low=4), 4, 'count is 3; valid is a number at least 4'),
        (lambda s: s.whole('count', low=4, high=5), 4, 'count is 3; valid is a whole number in 4..5'),
        (lambda s: s.whole('on', low=0, high=1), 5, 'on is True'),
        (lambda s: s.switch('count'), 4, 'count is 3; valid are true and false'),
        (lambda s: s.text('below'), 6, 'below must be a text'),
        (lambda s: s.text('name', among=('a', 'b')), 2, "name is 'press'; valid are a, b"),
        (lambda s: s.text('absent'), 2, 'absent is missing'),
        (lambda s: s.section('name'), 2, 'name must be a mapping'),
        (lambda s: list(s.sections('below')), 7, 'below must be a list'),
        (lambda s: s.texts('rows'), 9, 'rows must be texts'),
        (lambda s: s.finish(['nam']), 2, "unknown key 'name'; did you mean 'nam'?"),
        (lambda s: (s.section('below'), s.finish()), 7, "unknown key 'deep'"),
        (lambda s: ([*s.sections('rows')], s.finish()), 9, "unknown key 'a'"),
    ],
)
def test_a_wrong_value_is_reported_with_its_line(
    read: Callable[[YamlSection], object], line: int, message: str
):
    with pytest.raises(InvalidInputError) as info:
        read(parse_yaml(TEXT, 'x.yaml'))
    assert str(info.value).startswith(f'x.yaml:{line}: {message}')
    assert info.value.details['line'] == line


@pytest.mark.parametrize(
    ('text', 'line', 'message'),
    [
        ('a: 1\nb: [1, 2\nc: 3\n', 3, 'not YAML'),
        ('a: 1\n\nb: 2\na: 3\n', 4, "'a' stands here and in line 1"),
        ('- 1\n', 1, 'the file must be a mapping'),
        ('', 1, 'the file must be a mapping'),
        ('a: *nowhere\n', 1, 'not YAML'),
        ('a: "\\x07"\nb: \x07\n', 1, 'not YAML'),
    ],
)
def test_what_is_not_a_mapping_is_reported(text: str, line: int, message: str):
    with pytest.raises(InvalidInputError, match=rf'^x\.yaml:{line}: {message}'):
        parse_yaml(text, 'x.yaml')


def test_a_file_that_cannot_be_read_is_reported(tmp_path: Path):
    with pytest.raises(InvalidInputError, match=r'there is no file .*no\.yaml'):
        read_yaml(tmp_path / 'no.yaml')
    (tmp_path / 'b.yaml').write_bytes(b'\xff\xfe\x00')
    with pytest.raises(InvalidInputError, match=r'b\.yaml:1: byte 0xff is not UTF-8'):
        read_yaml(tmp_path / 'b.yaml')


@given(st.text(max_size=60))
def test_any_text_is_a_mapping_or_an_error_with_a_line(text: str):
    line = 0
    try:
        line = parse_yaml(text, 'x.yaml').line
    except InvalidInputError as error:
        line = int(error.details['line'])
    assert line >= 1

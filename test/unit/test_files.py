"""Files of users are read whole, or refused with what is wrong."""

import os
from pathlib import Path

import pytest

from robots_core.errors import InvalidInputError
from robots_core.files.user_file import read_bytes, read_text
from robots_core.files.yaml_section import parse_yaml, read_yaml_data


def test_a_text_is_read_without_its_byte_order_mark(tmp_path: Path):
    (tmp_path / 'a.txt').write_bytes('\ufeffmass: 1 µg'.encode())
    assert read_text(tmp_path / 'a.txt') == 'mass: 1 µg'


@pytest.mark.parametrize(
    ('make', 'message'),
    [
        (Path.exists, 'there is no scene'),
        (lambda path: path.mkdir(), 'is a directory; a scene is a file'),
        (lambda path: path.symlink_to('/dev/zero'), 'it is no regular file'),
        (os.mkfifo, 'it is no regular file'),
        (lambda path: path.symlink_to(path), 'cannot be read'),
        (lambda path: path.write_bytes(bytes(101)), 'has 101 bytes; at most 100 are read'),
        (lambda path: path.write_bytes(b'one\ntw\xff'), ':2: byte 0xff is not UTF-8'),
    ],
    ids=['missing', 'directory', 'device', 'pipe', 'circular link', 'large', 'not text'],
)
def test_what_cannot_be_read_is_refused_at_once(tmp_path: Path, make: object, message: str):
    path = tmp_path / 'scene.yaml'
    make(path)  # type: ignore[operator]
    with pytest.raises(InvalidInputError, match=message):
        read_text(path, 'scene', largest=100)


def test_a_null_character_in_a_path_is_refused():
    with pytest.raises(InvalidInputError, match='cannot be read'):
        read_bytes('a\0b')


LAUGHS = 'a: &a [x, x, x, x, x, x, x, x, x, x]\n' + ''.join(
    f'{name}: &{name} [{", ".join(10 * [f"*{before}"])}]\n'
    for before, name in zip('abcdefgh', 'bcdefghi', strict=True)
)


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        (LAUGHS, 'its aliases stand for over 1000000 values'),
        ('a: &a [*a]', 'its aliases stand for over'),
        ('a:\n' + 100_000 * '- ', 'nested too deeply'),
        ('a: !!python/object/apply:os.system [ls]', 'not valid: could not determine a constructor'),
        ('? [1, 2]\n: 3', 'not valid'),
        ('a: ' + 400 * '9', 'not valid: a number of 400 characters is too large'),
    ],
    ids=['many aliases', 'of itself', 'deep', 'tag', 'list as key', 'large number'],
)
def test_yaml_beyond_data_is_refused(tmp_path: Path, text: str, message: str):
    (tmp_path / 'a.yaml').write_text(text)
    with pytest.raises(InvalidInputError, match=rf'a\.yaml:1: .*{message}'):
        read_yaml_data(tmp_path / 'a.yaml')


def test_deep_sections_are_refused():
    with pytest.raises(InvalidInputError, match=r'a\.yaml:1: not YAML: nested too deeply'):
        parse_yaml('a: ' + 100_000 * '{a: ', 'a.yaml')

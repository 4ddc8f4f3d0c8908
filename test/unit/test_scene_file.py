"""Scene files: what they mean, and the line of every mistake."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from robots_core.blocks import read_scene
from robots_core.errors import InvalidInputError
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Mesh, Sphere

GOOD = """\
# A cell.
objects:
  - name: table
    box: {size: [1.0, 2.0, 0.1]}
    pose: {position: [1.0, 0.0, 0.5], angles: [1.5707963267948966, 0, 0]}
    colour: [0.1, 0.2, 0.3]
  - name: ball
    sphere: {radius: 0.2}
  - name: pole
    cylinder: {radius: 0.05, length: 2.0}
    pose: {position: [0, 1, 1], quaternion: [0, 0, 0, 2]}
  - name: hose
    capsule: {radius: 0.05, length: 1}
  - name: part
    mesh: {file: part.stl, scale: 0.001}
attached:
  - name: torch
    cylinder: {radius: 0.02, length: 0.3}
    pose: {position: [0, 0, 0.15]}
may_touch:
  - [torch, ball]
"""


def write(folder: Path, text: str) -> Path:
    path = folder / 'cell.yaml'
    path.write_text(text)
    trimesh.creation.box((100.0, 200.0, 300.0)).export(folder / 'part.stl')
    return path


def test_every_kind_of_object_is_read(tmp_path: Path):
    scene = read_scene(write(tmp_path, GOOD))
    table, ball, pole, hose, part = scene.objects
    assert (table.name, table.geometry, table.colour) == ('table', Box((1.0, 2.0, 0.1)), (0.1, 0.2, 0.3, 1.0))
    np.testing.assert_array_equal(table.pose.r, [1.0, 0.0, 0.5])
    # A quarter turn about z: x goes to y.
    np.testing.assert_allclose(table.pose.T @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)
    assert ball.geometry == Sphere(0.2)
    np.testing.assert_array_equal(ball.pose.T, np.eye(3))
    assert pole.geometry == Cylinder(0.05, 2.0)
    np.testing.assert_array_equal(pole.pose.T, np.eye(3))
    assert hose.geometry == Capsule(0.05, 1.0)
    assert isinstance(part.geometry, Mesh)
    np.testing.assert_allclose(np.ptp(part.geometry.vertices, axis=0), [0.1, 0.2, 0.3])
    (torch,) = scene.attached
    assert torch.name == 'torch'
    assert scene.allows('ball', 'torch')
    assert not scene.allows('pole', 'torch')


@pytest.mark.parametrize(
    ('good', 'bad', 'line', 'reason'),
    [
        ('objects:', 'objetcs:', 2, "unknown key 'objetcs'; did you mean 'objects'?"),
        ('colour: [0.1', 'color: [0.1', 6, "unknown key 'color'; did you mean 'colour'?"),
        ('  - name: table\n    box', '  - box', 3, 'name is missing'),
        ('size: [1.0, 2.0, 0.1]', 'size: [1.0, 2.0]', 4, 'must have shape'),
        ('size: [1.0, 2.0, 0.1]', 'size: [1.0, 2.0, 0]', 4, 'above 0'),
        ('size: [1.0, 2.0, 0.1]', 'size: [1.0, 2.0, .nan]', 4, 'nan'),
        ('size: [1.0, 2.0, 0.1]', 'edges: [1, 2, 3]', 4, 'size is missing'),
        ('position: [1.0, 0.0, 0.5]', 'position: here', 5, 'must be 3 numbers'),
        ('angles: [1.5', 'quaternion: [0, 0, 0, 1], angles: [1.5', 5, 'not both'),
        ('[0.1, 0.2, 0.3]', '[0.1, 0.2, 3]', 6, 'must be in [0, 1]'),
        ('name: ball', 'name: table', 7, "'table' is used in line 3 already"),
        ('name: ball', 'name: [ball]', 7, 'must be a text'),
        ('sphere: {radius: 0.2}', 'sphere: {radius: -0.2}', 8, 'sphere radius = -0.2 m'),
        ('sphere: {radius: 0.2}', 'sphere: {radius: big}', 8, "radius is 'big'; valid is a finite number"),
        ('sphere: {radius: 0.2}', 'sphere: 0.2', 8, 'sphere must be a mapping'),
        ('sphere: {radius: 0.2}', 'sphere: {radius: 1, size: 2}', 8, "unknown key 'size'; valid are radius"),
        ('    sphere: {radius: 0.2}\n', '', 7, 'has no geometry; needed is one of box'),
        ('sphere: {radius: 0.2}', 'sphere: {radius: 1}\n    box: {size: [1, 1, 1]}', 7, 'box and sphere'),
        ('cylinder: {radius: 0.05, length: 2.0}', 'cylinder: {radius: 1}', 10, 'length is missing'),
        ('[0, 0, 0, 2]', '[0, 0, 0, 0]', 11, 'length 0'),
        ('part.stl', 'missing.stl', 15, 'there is no mesh file'),
        ('[torch, ball]', '[torch]', 21, 'must be a pair of names'),
        ('[torch, ball]', '[torch, ball', 22, 'expected'),
    ],
)
def test_a_mistake_is_reported_with_its_line(tmp_path: Path, good: str, bad: str, line: int, reason: str):
    assert good in GOOD
    path = write(tmp_path, GOOD.replace(good, bad, 1))
    with pytest.raises(InvalidInputError) as info:
        read_scene(path)
    assert str(info.value).startswith(f'{path}:{line}: '), info.value
    assert reason in str(info.value)
    assert info.value.details['line'] == line


def test_a_missing_or_empty_file_is_reported(tmp_path: Path):
    with pytest.raises(InvalidInputError, match='there is no scene'):
        read_scene(tmp_path / 'missing.yaml')
    with pytest.raises(InvalidInputError, match='must be a mapping'):
        read_scene(write(tmp_path, '# nothing\n'))

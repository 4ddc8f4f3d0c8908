"""Shapes of a URDF are read once for its content."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from robots_core import Pose
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Shape, Sphere
from robots_core.robot_model.urdf.kept_shapes import kept_shapes

TRIANGLE = Mesh(np.eye(3), np.array([[0, 1, 2]]))
TURNED = Pose.from_quaternion([0.1, 0.2, 0.3], [0.5, 0.5, 0.5, 0.5])
SHAPES = tuple(
    Shape(geometry, frame, TURNED, (0.1, 0.2, 0.3, 0.4), f'link/{frame}')
    for frame, geometry in enumerate(
        [TRIANGLE, Box((1.0, 2.0, 3.0)), Cylinder(0.1, 0.2), Capsule(0.3, 0.4), Sphere(0.5)]
    )
)


class Reader:
    """Counts how often it reads."""

    def __init__(self) -> None:
        self.times = 0

    def __call__(self) -> tuple[Shape, ...]:
        self.times += 1
        return SHAPES


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('XDG_CACHE_HOME', str(tmp_path / 'cache'))


def urdf(*files: Path) -> str:
    meshes = ''.join(f'<visual><mesh scale="1" filename="file://{file}"/></visual>' for file in files)
    return f'<robot><link>{meshes}</link></robot>'


def cube(folder: Path, edge: float = 1.0, name: str = 'cube.stl') -> Path:
    trimesh.creation.box((edge, 1.0, 1.0)).export(folder / name)
    return folder / name


def numbers(geometry: Geometry) -> list[Any]:
    return [np.asarray(value).tolist() for value in vars(geometry).values()]


def test_what_is_kept_is_what_was_read(tmp_path: Path) -> None:
    read, xml = Reader(), urdf(cube(tmp_path))
    for _ in range(2):
        found = kept_shapes(xml, read, 'collision')
        for one, other in zip(found, SHAPES, strict=True):
            assert type(one.geometry) is type(other.geometry)
            assert numbers(one.geometry) == numbers(other.geometry)
            assert one.pose.distance_to(other.pose) == (0.0, 0.0)
            assert (one.frame, one.colour, one.name) == (other.frame, other.colour, other.name)
    assert read.times == 1


def test_another_mesh_text_or_option_is_read_anew(tmp_path: Path) -> None:
    read, xml = Reader(), urdf(cube(tmp_path))
    kept_shapes(xml, read, 'collision')
    kept_shapes(xml, read, 'visual')
    kept_shapes(xml + ' ', read, 'collision')
    cube(tmp_path, edge=2.0)
    kept_shapes(xml, read, 'collision')
    assert read.times == 4


@pytest.mark.parametrize('name', ['cube.gltf', 'none.stl'])
def test_what_may_be_in_other_files_or_is_missing_is_read_every_time(tmp_path: Path, name: str) -> None:
    read, files = Reader(), [cube(tmp_path), tmp_path / name]
    if name == 'cube.gltf':
        files[-1].write_text('{}')
    for _ in range(2):
        assert kept_shapes(urdf(*files), read) is SHAPES
    assert kept_shapes(urdf(), read) is SHAPES
    assert read.times == 3

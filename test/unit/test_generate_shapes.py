"""The meshes that are committed are those that the robots' drawings make."""

from __future__ import annotations

import shutil
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import trimesh

from generate_shapes import DRAWINGS, MESHES, drawn_at, generate_shapes, main

FOLDER = Path(str(files('robots_models')))
ROBOTS = sorted(folder.parent.name for folder in FOLDER.glob(f'*/{MESHES}'))  # others use theirs
LARGEST_FILE = 60_000  # bytes
# STL holds single precision: 1e-7 of coordinates of up to 3 m.
STL_PRECISION = 1e-6


@pytest.fixture(params=ROBOTS)
def drawn(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, Path]:
    """A robot's folder, and a copy of it that was drawn anew."""
    folder = FOLDER / request.param
    shutil.copy(folder / 'robot.urdf', tmp_path)
    generate_shapes(tmp_path, DRAWINGS[request.param], drawn_at(request.param))
    return folder, tmp_path


def test_urdf_is_as_drawn(drawn: tuple[Path, Path]):
    folder, copy = drawn
    assert (copy / 'robot.urdf').read_text() == (folder / 'robot.urdf').read_text()


def test_meshes_are_as_drawn(drawn: tuple[Path, Path]):
    folder, copy = drawn
    names = {file.name for file in (copy / MESHES).iterdir()}
    assert names == {file.name for file in (folder / MESHES).iterdir()}
    for name in names:
        mine, its = (trimesh.load_mesh(root / MESHES / name, process=False) for root in (folder, copy))
        np.testing.assert_allclose(mine.triangles, its.triangles, atol=STL_PRECISION, err_msg=name)


def test_meshes_are_small_closed_solids(drawn: tuple[Path, Path]):
    for file in (drawn[0] / MESHES).iterdir():
        assert file.stat().st_size < LARGEST_FILE, file.name
        mesh = trimesh.load_mesh(file)
        assert mesh.is_watertight, file.name
        assert mesh.volume > 0.0, file.name


def test_main_draws_into_another_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    robot = ROBOTS[0]
    (tmp_path / robot).mkdir()
    shutil.copy(FOLDER / robot / 'robot.urdf', tmp_path / robot)
    main([robot, '--into', str(tmp_path)])
    assert robot in capsys.readouterr().out
    assert len(list((tmp_path / robot / MESHES).glob('*.stl'))) == len(
        list((FOLDER / robot / MESHES).iterdir())
    )

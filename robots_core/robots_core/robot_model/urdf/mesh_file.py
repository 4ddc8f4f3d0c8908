"""Triangle meshes from files: STL, OBJ, PLY, COLLADA and further formats of trimesh."""

from pathlib import Path
from typing import Final

import numpy as np
import trimesh
from numpy.typing import ArrayLike
from trimesh.resolvers import FilePathResolver

from robots_core.errors import InvalidInputError
from robots_core.files.user_file import MAX_MESH, check_file, exists
from robots_core.robot_model.shapes import Mesh

LFS_POINTER: Final = b'version https://git-lfs'


class _ReadableFiles(FilePathResolver):  # type: ignore[misc]  # trimesh has no types there
    """Files that a mesh names, as its materials: those alone that can be read whole."""

    def absolute(self, name: str) -> Path:
        path = Path(super().absolute(name))
        if exists(path):
            check_file(path, 'file of a mesh', largest=MAX_MESH)
        return path


def read_mesh(path: Path, scale: ArrayLike = 1.0) -> Mesh:
    """The mesh of a file, in metres.

    Args:
        path: The file.
        scale: Metres per unit of the file, one number or three (x, y, z). COLLADA files state their unit
            themselves; the scale is applied in addition.

    Raises:
        InvalidInputError: a file that cannot be read or holds no triangles.
    """
    check_file(path, 'mesh file', largest=MAX_MESH)
    with path.open('rb') as file:
        if file.read(len(LFS_POINTER)) == LFS_POINTER:
            raise InvalidInputError(f'mesh file {str(path)!r} is a pointer of Git LFS: run git lfs pull')
    try:
        mesh = trimesh.load_mesh(path, resolver=_ReadableFiles(str(path)))
        faces, vertices = np.asarray(mesh.faces), np.asarray(mesh.vertices)
        factor = np.asarray(scale, dtype=np.float64)
        if path.suffix.lower() == '.dae' and mesh.units:
            factor = factor * trimesh.units.unit_conversion(mesh.units, 'meters')
    except Exception as error:  # the readers of trimesh raise whatever a damaged file leads to
        raise InvalidInputError(f'mesh file {str(path)!r} cannot be read: {error}') from error
    if len(faces) == 0:
        raise InvalidInputError(f'mesh file {str(path)!r} cannot be read: it holds no triangles')
    if not np.isfinite(vertices).all():
        raise InvalidInputError(f'mesh file {str(path)!r} cannot be read: a corner is not finite')
    if not 0 <= faces.min() <= faces.max() < len(vertices):
        raise InvalidInputError(f'mesh file {str(path)!r} cannot be read: a triangle lacks a corner')
    return Mesh(vertices * factor, faces)

"""Triangle meshes from files: STL, OBJ, PLY, COLLADA and further formats of trimesh."""

from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.robot_model.shapes import Mesh


def read_mesh(path: Path, scale: ArrayLike = 1.0) -> Mesh:
    """The mesh of a file, in metres.

    Args:
        path: The file.
        scale: Metres per unit of the file, one number or three (x, y, z). COLLADA files state their unit
            themselves; the scale is applied in addition.

    Raises:
        InvalidInputError: a file that cannot be read or holds no triangles.
    """
    try:
        mesh = trimesh.load_mesh(path)
    except (ValueError, NotImplementedError, OSError) as error:
        raise InvalidInputError(f'mesh file {str(path)!r} cannot be read: {error}') from error
    if len(mesh.faces) == 0:
        raise InvalidInputError(f'mesh file {str(path)!r} cannot be read: it holds no triangles')
    factor = np.asarray(scale, dtype=np.float64)
    if path.suffix.lower() == '.dae' and mesh.units:
        factor = factor * trimesh.units.unit_conversion(mesh.units, 'meters')
    return Mesh(np.asarray(mesh.vertices) * factor, np.asarray(mesh.faces))

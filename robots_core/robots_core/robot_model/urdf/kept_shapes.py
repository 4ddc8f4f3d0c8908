"""Shapes of a URDF, kept by the content of its files: the libraries that read them take longer to import."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Final, get_args

import numpy as np

from robots_core.errors import RobotsError
from robots_core.files.content_cache import Arrays, content_of, kept
from robots_core.files.user_file import MAX_MESH, read_bytes
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Geometry, Mesh, Shape
from robots_core.robot_model.urdf.urdf_meshes import mesh_path

_MESH: Final = re.compile(r'<mesh\s[^>]*?filename\s*=\s*"([^"]+)"')
_ALONE: Final = ('.stl', '.dae', '.obj', '.ply')
"""Formats whose triangles are all in the file that the URDF names."""
_KINDS: Final[dict[str, Callable[..., Geometry]]] = {kind.__name__: kind for kind in get_args(Geometry)}


def kept_shapes(xml: str, read: Callable[[], tuple[Shape, ...]], *options: object) -> tuple[Shape, ...]:
    """What `read` returns, computed once for a URDF, its meshes and options; every time if it has no meshes.

    The meshes are named by absolute addresses.
    """
    try:
        contents = _mesh_contents(xml)
    except RobotsError:  # which the reader names with its link
        contents = []
    if not contents:
        return read()
    arrays = kept('geometries', content_of((xml, options, *contents)), lambda: _arrays_of(read()))
    return tuple(_shape(arrays, index) for index in range(len(arrays['frames'])))


def _mesh_contents(xml: str) -> list[bytes]:
    """The bytes of all meshes; none if triangles may be in other files too."""
    names = sorted(set(_MESH.findall(xml)))
    if not all(name.lower().endswith(_ALONE) for name in names):
        return []
    return [read_bytes(mesh_path(name, Path()), 'mesh file', largest=MAX_MESH) for name in names]


def _arrays_of(shapes: tuple[Shape, ...]) -> Arrays:
    arrays = {
        'names': np.array([shape.name for shape in shapes]),
        'kinds': np.array([type(shape.geometry).__name__ for shape in shapes]),
        'frames': np.array([shape.frame for shape in shapes]),
        'r': np.array([shape.pose.r for shape in shapes]),
        'T': np.array([shape.pose.T for shape in shapes]),
        'colours': np.array([shape.colour for shape in shapes]),
    }
    for index, shape in enumerate(shapes):
        arrays |= {f'{index}.{name}': np.array(value) for name, value in vars(shape.geometry).items()}
    return arrays


def _shape(arrays: Arrays, index: int) -> Shape:
    red, green, blue, opacity = arrays['colours'][index].tolist()
    return Shape(
        geometry=_geometry(arrays, index),
        frame=int(arrays['frames'][index]),
        pose=Pose(arrays['r'][index], arrays['T'][index]),
        colour=(red, green, blue, opacity),
        name=str(arrays['names'][index]),
    )


def _geometry(arrays: Arrays, index: int) -> Geometry:
    kind = str(arrays['kinds'][index])
    values = {key.partition('.')[2]: arrays[key] for key in arrays if key.startswith(f'{index}.')}
    if kind == Mesh.__name__:
        return Mesh(**values)
    return _KINDS[kind](**{name: tuple(v.tolist()) if v.ndim else v.item() for name, v in values.items()})

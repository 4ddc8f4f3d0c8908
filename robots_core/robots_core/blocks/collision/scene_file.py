"""Scenes from YAML files; errors name the line."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import yaml

from robots_core.blocks.collision.scene import OBJECT_COLOUR, AttachedObject, Scene, SceneObject
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.validation import Array, finite_vector, fraction

GEOMETRIES = {
    'box': ('size',),
    'sphere': ('radius',),
    'cylinder': ('radius', 'length'),
    'capsule': ('radius', 'length'),
    'mesh': ('file', 'scale'),
}
"""Kinds of geometry and their keys; `scale` is optional."""
SCENE_KEYS = ('objects', 'attached', 'may_touch')
POSE_KEYS = ('position', 'angles', 'quaternion')

Made = TypeVar('Made')


def read_scene(path: Path | str) -> Scene:
    """The scene of a YAML file.

    The README describes the format: lists `objects` (in the base frame), `attached` (in tool0) and
    `may_touch`; lengths in metres, angles in radians about z, the new y and the new x.

    Raises:
        InvalidInputError: a file that is missing or not such a scene; names the file and the line.
    """
    return _SceneFile(Path(path)).scene()


class _SceneFile:
    """A scene file being read, as YAML nodes with line numbers."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            root = yaml.compose(path.read_text(), Loader=yaml.SafeLoader)
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            raise InvalidInputError(f'{path}:{line}: {error.problem or error}', line=line) from error
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise InvalidInputError(f'scene {str(path)!r} cannot be read: {error}') from error
        if root is None:
            raise InvalidInputError(
                f'{path}:1: the file is empty; expected are {", ".join(SCENE_KEYS)}', line=1
            )
        self._root = root

    def scene(self) -> Scene:
        parts = self._mapping(self._root, SCENE_KEYS)
        objects = tuple(self._object(node, SceneObject) for node in self._items(parts.get('objects')))
        attached = tuple(self._object(node, AttachedObject) for node in self._items(parts.get('attached')))
        pairs = set()
        for node in self._items(parts.get('may_touch')):
            names = self._value(node)
            if not (isinstance(names, list) and len(names) == 2 and all(isinstance(n, str) for n in names)):
                raise self._error(node, f'{names!r} must be a pair of names [one, other]')
            pairs.add((names[0], names[1]))
        self._check_names(parts)
        return Scene(objects, attached, frozenset(pairs))

    def _check_names(self, parts: dict[str, yaml.Node]) -> None:
        lines: dict[str, int] = {}
        for node in (*self._items(parts.get('objects')), *self._items(parts.get('attached'))):
            name_node = self._mapping(node)['name']
            name = str(self._value(name_node))
            if name in lines:
                raise self._error(name_node, f'the name {name!r} is used in line {lines[name]} already')
            lines[name] = name_node.start_mark.line + 1

    def _object(self, node: yaml.Node, kind: Callable[..., Any]) -> Any:
        parts = self._mapping(node, ('name', *GEOMETRIES, 'pose', 'colour'))
        if 'name' not in parts:
            raise self._error(node, 'an object needs a name')
        name = self._value(parts['name'])
        if not isinstance(name, str) or not name:
            raise self._error(parts['name'], f'name {name!r} must be a text')
        kinds = [key for key in GEOMETRIES if key in parts]
        if len(kinds) != 1:
            raise self._error(
                node,
                f'object {name!r} has {" and ".join(kinds) or "no geometry"}; needed is one of '
                f'{", ".join(GEOMETRIES)}',
            )
        colour = OBJECT_COLOUR
        if 'colour' in parts:
            colour = self._checked(parts['colour'], _colour)
        pose = self._pose(parts['pose']) if 'pose' in parts else Pose.identity()
        return kind(name, self._geometry(kinds[0], parts[kinds[0]]), pose, colour)

    def _geometry(self, kind: str, node: yaml.Node) -> Geometry:
        parts = self._mapping(node, GEOMETRIES[kind])
        missing = [key for key in GEOMETRIES[kind] if key not in parts and key != 'scale']
        if missing:
            raise self._error(node, f'{kind} lacks {missing[0]}')
        if kind == 'mesh':
            file, scale = self._value(parts['file']), 1.0
            if 'scale' in parts:
                scale = self._checked(parts['scale'], _number)
            path = self._path.parent / str(file)
            # Imported on demand: scenes without meshes need no mesh library.
            read_mesh: Callable[..., Mesh] = import_module('robots_core.robot_model.urdf.mesh_file').read_mesh
            return self._checked(parts['file'], lambda _: read_mesh(path, scale))
        if kind == 'box':
            return self._checked(parts['size'], _box)
        numbers = {key: self._checked(parts[key], _number) for key in GEOMETRIES[kind]}
        made: dict[str, Callable[..., Geometry]] = {
            'sphere': Sphere,
            'cylinder': Cylinder,
            'capsule': Capsule,
        }
        return self._checked(node, lambda _: made[kind](**numbers))

    def _pose(self, node: yaml.Node) -> Pose:
        parts = self._mapping(node, POSE_KEYS)
        position = np.zeros(3)
        if 'position' in parts:
            position = self._checked(parts['position'], lambda value: finite_vector(value, 3, 'position'))
        if 'angles' in parts and 'quaternion' in parts:
            raise self._error(node, 'a pose has angles or a quaternion, not both')
        if 'quaternion' in parts:
            return self._checked(parts['quaternion'], lambda value: Pose.from_quaternion(position, value))
        if 'angles' in parts:
            return self._checked(parts['angles'], lambda value: Pose.from_angles(position, value))
        return Pose(position, np.eye(3))

    # -- nodes ---------------------------------------------------------------------------------------

    def _error(self, node: yaml.Node, message: str) -> InvalidInputError:
        line = node.start_mark.line + 1
        return InvalidInputError(f'{self._path}:{line}: {message}', line=line)

    def _value(self, node: yaml.Node) -> Any:
        loader = yaml.SafeLoader('')
        try:
            return loader.construct_document(node)
        except yaml.MarkedYAMLError as error:
            raise self._error(node, str(error.problem)) from error
        finally:
            loader.dispose()

    def _checked(self, node: yaml.Node, make: Callable[[Any], Made]) -> Made:
        """The result of `make` for the node's value; its errors are raised with the line."""
        try:
            return make(self._value(node))
        except RobotsError as error:
            raise self._error(node, error.message) from error

    def _mapping(self, node: yaml.Node, known: tuple[str, ...] = ()) -> dict[str, yaml.Node]:
        if not isinstance(node, yaml.MappingNode):
            raise self._error(node, f'expected are {", ".join(known)}, got {self._value(node)!r}')
        found: dict[str, yaml.Node] = {}
        for key_node, value_node in node.value:
            key = str(self._value(key_node))
            if known and key not in known:
                raise self._error(key_node, f'{key!r} is unknown; known are {", ".join(known)}')
            if key in found:
                raise self._error(key_node, f'{key!r} stands here twice')
            found[key] = value_node
        return found

    def _items(self, node: yaml.Node | None) -> list[yaml.Node]:
        if node is None or (isinstance(node, yaml.ScalarNode) and node.value == ''):
            return []
        if not isinstance(node, yaml.SequenceNode):
            raise self._error(node, f'expected is a list, got {self._value(node)!r}')
        return list(node.value)


def _box(size: Any) -> Box:
    x, y, z = finite_vector(size, 3, 'size').tolist()
    return Box((x, y, z))


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InvalidInputError(f'{value!r} is not a number')
    return float(value)


def _colour(value: Any) -> tuple[float, float, float, float]:
    count = len(value) if isinstance(value, list) else 4
    channels: Array = finite_vector(value, 3 if count == 3 else 4, 'colour')
    rgba = [fraction(float(channel), 'colour') for channel in channels] + [1.0]
    return rgba[0], rgba[1], rgba[2], rgba[3]

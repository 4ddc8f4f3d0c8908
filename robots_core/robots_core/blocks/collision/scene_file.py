"""Scenes from YAML files; errors name the line."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, Final, TypeVar

from robots_core.blocks.collision.scene import OBJECT_COLOUR, AttachedObject, PlacedObject, Scene, SceneObject
from robots_core.blocks.zones.zone_section import read_zone
from robots_core.files.placed_section import read_name, read_pose
from robots_core.files.user_file import read_text
from robots_core.files.yaml_section import YamlSection, located, parse_yaml
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.validation import finite_vector, fraction
from robots_core.wording.nearest_name import did_you_mean, nearest_name

ROUND: Final[dict[str, tuple[Callable[..., Geometry], tuple[str, ...]]]] = {
    'sphere': (Sphere, ('radius',)),
    'cylinder': (Cylinder, ('radius', 'length')),
    'capsule': (Capsule, ('radius', 'length')),
}
GEOMETRIES: Final = ('box', *ROUND, 'mesh')
Placed = TypeVar('Placed', bound=PlacedObject)


def read_scene(path: Path | str) -> Scene:
    """The scene of a YAML file.

    `docs/reference/scene_file.md` describes the format: lists `objects` and `zones` (in the base frame),
    `attached` (in tool0) and `may_touch`; lengths in metres, angles in radians about z, the new y and the
    new x.

    Raises:
        InvalidInputError: a file that is missing or not such a scene; names the file and the line.
    """
    section = parse_yaml(read_text(path, 'scene'), str(path))
    lines: dict[str, int] = {}

    def placed(key: str, kind: type[Placed]) -> tuple[Placed, ...]:
        return tuple(_object(item, kind, lines, Path(path).parent) for item in section.sections(key))

    objects, attached = placed('objects', SceneObject), placed('attached', AttachedObject)
    pairs = set()
    for names, line in section.values('may_touch'):
        if not (isinstance(names, list) and len(names) == 2 and all(isinstance(n, str) for n in names)):
            raise located(section.file, line, f'{names!r} must be a pair of names [one, other]')
        pairs.add((names[0], names[1]))
    zones = tuple(read_zone(item, lines) for item in section.sections('zones'))
    section.finish()
    return Scene(objects, attached, frozenset(pairs), zones)


def _object(item: YamlSection, kind: type[Placed], lines: dict[str, int], folder: Path) -> Placed:
    name = read_name(item, lines)
    kinds = [key for key in GEOMETRIES if key in item]
    if len(kinds) != 1:
        foreign = next((key for key in item.keys if nearest_name(key, GEOMETRIES) not in (None, key)), '')
        raise item.error(
            f'object {name!r} has {" and ".join(kinds) or "no geometry"}; needed is one of '
            f'{", ".join(GEOMETRIES)}{did_you_mean(foreign, GEOMETRIES)}',
            foreign,
        )
    colour = item.made('colour', _colour) if 'colour' in item else OBJECT_COLOUR
    geometry, pose = _geometry(item, kinds[0], folder), read_pose(item.section('pose'))
    item.finish((*GEOMETRIES, 'colour'))
    return kind(name, geometry, pose, colour)


def _geometry(item: YamlSection, kind: str, folder: Path) -> Geometry:
    parts = item.needed_section(kind)
    geometry: Geometry
    if kind == 'mesh':
        # Imported on demand: scenes without meshes need no mesh library.
        read_mesh: Callable[..., Mesh] = import_module('robots_core.robot_model.urdf.mesh_file').read_mesh
        scale = parts.number('scale', 1.0)
        geometry = parts.made('file', lambda name: read_mesh(folder / str(name), scale))
    elif kind == 'box':
        geometry = parts.made('size', lambda size: Box(tuple(finite_vector(size, 3, 'size').tolist())))
    else:
        make, keys = ROUND[kind]
        numbers = {key: parts.number(key) for key in keys}
        geometry = parts.checked(lambda: make(**numbers))
    return geometry


def _colour(value: Any) -> tuple[float, float, float, float]:
    count = len(value) if isinstance(value, list) else 4
    channels = finite_vector(value, 3 if count == 3 else 4, 'colour')
    rgba = [fraction(float(channel), 'colour') for channel in channels] + [1.0]
    return rgba[0], rgba[1], rgba[2], rgba[3]

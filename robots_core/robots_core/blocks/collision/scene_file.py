"""Scenes from YAML files; errors name the line."""

import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeVar

from robots_core.blocks.collision.scene import OBJECT_COLOUR, AttachedObject, PlacedObject, Scene, SceneObject
from robots_core.blocks.zones.zone import HalfSpace, Keep, PlacedBox, What, Zone
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
KEEP: Final[dict[str, Keep]] = {'in': 'in', 'out': 'out'}
NAMESPACE: Final = re.compile(r'/|(/[A-Za-z_]\w*)+', re.ASCII)
WHAT: Final[dict[str, What]] = {'tool': 'tool', 'bodies': 'bodies'}
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
    zones = tuple(_read_zone(item, lines) for item in section.sections('zones'))
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
        geometry = _box(parts)
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


def _read_zone(item: YamlSection, lines: dict[str, int]) -> Zone:
    """A zone; `lines` holds those of all names."""
    name = read_name(item, lines)
    kinds = [key for key in ('box', 'plane') if key in item]
    if len(kinds) != 1:
        raise item.error(
            f'zone {name!r} has {" and ".join(kinds) or "neither box nor plane"}; needed is one of both'
        )
    region: PlacedBox | HalfSpace
    if 'box' in item:
        region = PlacedBox(_box(item.needed_section('box')), read_pose(item.section('pose')))
    else:
        region = _plane(item.needed_section('plane'))
    zone = Zone(
        name,
        region,
        KEEP[item.text('keep', among=KEEP)],
        WHAT[item.text('what', among=WHAT)],
        MappingProxyType(_closed_by(item)),
        _shared_with(item),
    )
    item.finish(('box', 'plane'))
    return zone


def _box(parts: YamlSection) -> Box:
    return parts.made('size', lambda size: Box(tuple(finite_vector(size, 3, 'size').tolist())))


def _plane(parts: YamlSection) -> HalfSpace:
    point = parts.made('point', lambda value: finite_vector(value, 3, 'point'))
    normal = parts.made('normal', lambda value: finite_vector(value, 3, 'normal'))
    return parts.checked(lambda: HalfSpace(point, normal))


def _closed_by(item: YamlSection) -> dict[str, bool]:
    parts = item.section('closed_by')
    if parts is None:
        return {}
    if not parts.keys:
        raise parts.error('closed_by names no input; without closed_by the zone is always closed')
    return {key: parts.switch(key) for key in parts.keys}


def _shared_with(item: YamlSection) -> tuple[str, ...]:
    names = item.texts('shared_with')
    if not names and 'shared_with' in item:
        raise item.error(
            'shared_with names no robot; without it the zone is of this robot alone', 'shared_with'
        )
    for place, (name, line) in enumerate(names):
        if not NAMESPACE.fullmatch(name):
            raise located(item.file, line, f'{name!r} is no namespace of a robot; valid are /robot_b and /')
        if name in [earlier for earlier, _ in names[:place]]:
            raise located(item.file, line, f'{name} stands twice in shared_with')
    return tuple(name for name, _ in names)

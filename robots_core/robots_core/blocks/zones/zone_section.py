"""Zones in scene files."""

import re
from types import MappingProxyType
from typing import Final

from robots_core.blocks.zones.zone import HalfSpace, Keep, PlacedBox, What, Zone
from robots_core.files.placed_section import read_name, read_pose
from robots_core.files.yaml_section import YamlSection, located
from robots_core.robot_model.shapes import Box
from robots_core.validation import finite_vector

KEEP: Final[dict[str, Keep]] = {'in': 'in', 'out': 'out'}
NAMESPACE: Final = re.compile(r'/|(/[A-Za-z_]\w*)+', re.ASCII)
WHAT: Final[dict[str, What]] = {'tool': 'tool', 'bodies': 'bodies'}


def read_zone(item: YamlSection, lines: dict[str, int]) -> Zone:
    """A zone of a scene file; `lines` holds those of all names.

    Raises:
        InvalidInputError: what is wrong; with its line.
    """
    name = read_name(item, lines)
    kinds = [key for key in ('box', 'plane') if key in item]
    if len(kinds) != 1:
        raise item.error(
            f'zone {name!r} has {" and ".join(kinds) or "neither box nor plane"}; needed is one of both'
        )
    region = _box(item) if 'box' in item else _plane(item)
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


def _box(item: YamlSection) -> PlacedBox:
    parts = item.needed_section('box')
    box = parts.made('size', lambda size: Box(tuple(finite_vector(size, 3, 'size').tolist())))
    return PlacedBox(box, read_pose(item.section('pose')))


def _plane(item: YamlSection) -> HalfSpace:
    parts = item.needed_section('plane')
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

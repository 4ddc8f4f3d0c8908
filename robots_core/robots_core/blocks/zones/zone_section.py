"""Zones in scene files."""

from types import MappingProxyType
from typing import Final

from robots_core.blocks.collision.placed_section import read_name, read_pose
from robots_core.blocks.zones.zone import HalfSpace, Keep, PlacedBox, What, Zone
from robots_core.errors import RobotsError
from robots_core.robot_model.shapes import Box
from robots_core.validation import finite_vector
from robots_core.yaml_section import YamlSection

KEEP: Final[dict[str, Keep]] = {'in': 'in', 'out': 'out'}
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
    )
    item.finish(('box', 'plane'))
    return zone


def _box(item: YamlSection) -> PlacedBox:
    parts = item.section('box')
    assert parts is not None
    box = parts.made('size', lambda size: Box(tuple(finite_vector(size, 3, 'size').tolist())))
    parts.finish()
    return PlacedBox(box, read_pose(item.section('pose')))


def _plane(item: YamlSection) -> HalfSpace:
    parts = item.section('plane')
    assert parts is not None
    point = parts.made('point', lambda value: finite_vector(value, 3, 'point'))
    normal = parts.made('normal', lambda value: finite_vector(value, 3, 'normal'))
    parts.finish()
    try:
        return HalfSpace(point, normal)
    except RobotsError as error:
        raise parts.error(error.message) from error


def _closed_by(item: YamlSection) -> dict[str, bool]:
    parts = item.section('closed_by')
    if parts is None:
        return {}
    if not parts.keys:
        raise parts.error('closed_by names no input; without closed_by the zone is always closed')
    found = {key: parts.switch(key) for key in parts.keys}
    parts.finish()
    return found

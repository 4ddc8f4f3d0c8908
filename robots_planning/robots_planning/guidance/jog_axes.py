"""JogAxes: the axes along and about which a tool is jogged."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, get_args

from robots_core.errors import InvalidInputError

JogAxes = Literal['base', 'base_link', 'tool', 'world']
JOG_AXES: tuple[JogAxes, ...] = get_args(JogAxes)
JOG_FRAMES: Mapping[str, JogAxes] = MappingProxyType(
    {'': 'base', 'base': 'base', 'base_link': 'base_link', 'tool': 'tool', 'tool0': 'tool', 'world': 'world'}
)


def jog_axes(frame: str) -> JogAxes:
    """Axes to jog a tool in, by the frame of a jog message.

    Raises:
        InvalidInputError: an unknown frame.
    """
    if frame not in JOG_FRAMES:
        raise InvalidInputError(
            f'frame {frame!r} is unknown; tools are jogged in {", ".join(filter(None, JOG_FRAMES))}'
        )
    return JOG_FRAMES[frame]

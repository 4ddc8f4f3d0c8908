"""CellFrames: the tools and bases of a cell, by name, in one YAML file beside its programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal

from robots_controller.program.files.atomic_file import write_text, yaml_text
from robots_core.blocks.multibody.payload import payload_of
from robots_core.errors import InvalidInputError, ProgramError
from robots_core.files.placed_section import read_pose
from robots_core.files.user_file import read_text
from robots_core.files.yaml_section import YamlSection, compose_yaml, parse_yaml
from robots_core.pose import Pose

FRAMES_FILE: Final = 'frames.yaml'
WHAT: Final = 'frames file'
FrameKind = Literal['tool', 'base']
HEADER: Final = (
    '# Tools and bases of the cell. position: m. quaternion: x y z w; or angles: rad, about z, the new y\n'
    '# and the new x. Tools are seen from the flange (tool0), bases from the base of the robot.\n'
    '# payload: of the tool, kg and centre of mass x y z in tool0, m, maybe inertia xx xy xz yy yz zz.\n'
)


@dataclass(frozen=True, eq=False)
class Tool:
    """A tool.

    Attributes:
        pose: Its tool centre point, seen from tool0.
        payload: 4 or 10 numbers, see `payload_of`; () where it is not known.
    """

    pose: Pose
    payload: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class CellFrames:
    """Tools and bases by name.

    Attributes:
        tools: Seen from tool0.
        bases: Seen from the base of the robot.
    """

    tools: Mapping[str, Tool] = field(default_factory=lambda: MappingProxyType({}))
    bases: Mapping[str, Pose] = field(default_factory=lambda: MappingProxyType({}))

    def with_tool(self, name: str, tool: Tool) -> CellFrames:
        """The same with a tool; one that has the name is replaced.

        Raises:
            InvalidInputError: an empty name.
        """
        return replace(self, tools={**self.tools, checked_name(name, 'tool'): tool})

    def with_base(self, name: str, base: Pose) -> CellFrames:
        """The same with a base; one that has the name is replaced.

        Raises:
            InvalidInputError: an empty name.
        """
        return replace(self, bases={**self.bases, checked_name(name, 'base'): base})

    def names(self, kind: FrameKind) -> tuple[str, ...]:
        """Names of all tools or bases, sorted."""
        return tuple(sorted(self.tools if kind == 'tool' else self.bases))


def read_frames(path: Path) -> CellFrames:
    """Tools and bases of a file; none if there is no file.

    Raises:
        InvalidInputError: it is not valid; names file and line.
    """
    if not path.exists():
        return CellFrames()
    text = read_text(path, WHAT)
    if compose_yaml(text, path.name) is None:
        return CellFrames()
    section = parse_yaml(text, path.name)
    tools = {name: _tool(below, name) for below, name in section.entries('tools')}
    bases = {name: read_pose(below.section(name)) for below, name in section.entries('bases')}
    section.finish()
    return CellFrames(tools, bases)


def check_frame(path: Path, kind: FrameKind, name: str) -> CellFrames:
    """Tools and bases of a file that has this one.

    Raises:
        ProgramError: it has none of that name; names those that it has.
        InvalidInputError: it is not valid.
    """
    frames = read_frames(path)
    known = frames.names(kind)
    if name not in known:
        where = path.name if path.exists() else f'{path.name}, which does not exist'
        named = ', '.join(known) or 'none'
        raise ProgramError(
            f'no {kind} is named {name!r} in {where}; {kind}s are {named}',
            key=f'unknown_{kind}',
            name=name,
            known=named,
        )
    return frames


def write_frames(path: Path, frames: CellFrames) -> None:
    """Write a frames file: the whole new one or, whatever happens, the whole old one.

    Raises:
        ProgramError: it cannot be written.
    """
    write_text(path, frames_text(frames), WHAT)


def frames_text(frames: CellFrames) -> str:
    """What `write_frames` writes."""
    tools = {
        name: _entry(tool.pose) | ({'payload': list(tool.payload)} if tool.payload else {})
        for name, tool in sorted(frames.tools.items())
    }
    bases = {name: _entry(base) for name, base in sorted(frames.bases.items())}
    return yaml_text({'tools': tools, 'bases': bases}, HEADER)


def checked_name(name: str, kind: FrameKind) -> str:
    """A name that is not empty.

    Raises:
        InvalidInputError: it is empty.
    """
    if not name.strip():
        raise InvalidInputError(
            f"the name of the {kind} is empty; valid is a text, such as 'gripper'", key=f'unnamed_{kind}'
        )
    return name.strip()


def _tool(below: YamlSection, name: str) -> Tool:
    parts = below.section(name)
    if parts is None or 'payload' not in parts:
        return Tool(read_pose(parts))
    payload = parts.made('payload', _payload)
    return Tool(read_pose(parts), payload)


def _payload(values: Any) -> tuple[float, ...]:
    if not isinstance(values, list):
        raise InvalidInputError(f'payload is {values!r}; valid is a list of 4 or 10 numbers')
    payload_of(values)
    return tuple(float(value) for value in values)


def _entry(pose: Pose) -> dict[str, Any]:
    return {'position': pose.r.tolist(), 'quaternion': pose.quaternion().tolist()}

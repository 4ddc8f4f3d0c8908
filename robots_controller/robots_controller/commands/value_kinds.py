"""The kinds of values that options take: each refuses, at once, what is not valid."""

from __future__ import annotations

import argparse
import math
import os
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from robots_core.errors import RobotsError
from robots_core.files.user_file import exists

LARGEST_PORT: Final = 65535
PLACES: Final = tuple(
    f'{folders}{file}' for folders in ('', '*/', '*/*/') for file in ('metadata.yaml', '*.mcap', '*.db3')
)
"""Where the files of a bag are, seen from a folder."""
MOST_BAGS: Final = 5
"""Bags that a message names."""
METAVARS: Final = {'s': 'SECONDS', 'Hz': 'HZ', 'rad': 'RAD', 'm/s': 'M_PER_S'}
_NAMESPACE: Final = re.compile(r'/|(/[A-Za-z_][A-Za-z0-9_]*)+')


def number(unit: str, *, above: float = -math.inf, least: float = -math.inf) -> Callable[[str], float]:
    """A finite number.

    Args:
        unit: Its unit, for messages.
        above: Below all that are valid.
        least: The smallest that is valid.
    """

    def kind(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and value > above and value >= least):
            bound = f'above {above:g}' if above > -math.inf else f'of at least {least:g}'
            raise argparse.ArgumentTypeError(f'{text!r} is not valid; valid is a number {bound}, in {unit}')
        return value

    return kind


def whole_number(least: int, most: int | None = None) -> Callable[[str], int]:
    """A whole number within bounds, which are valid too."""

    def kind(text: str) -> int:
        bounds = f'of at least {least}' if most is None else f'in {least}..{most}'
        if not re.fullmatch(r'[+-]?\d+', text) or not least <= int(text) <= (most or int(text)):
            raise argparse.ArgumentTypeError(f'{text!r} is not valid; valid is a whole number {bounds}')
        return int(text)

    return kind


port: Final = whole_number(0, LARGEST_PORT)


def namespace(text: str) -> str:
    """A ROS namespace, with its first slash."""
    full = '/' + text.strip('/')
    if not _NAMESPACE.fullmatch(full):
        raise argparse.ArgumentTypeError(
            f'{text!r} is not valid; valid are letters, digits and _, parts of it separated by /, none of '
            f'which begins with a digit, for example {_valid(full)}'
        )
    return full


def _valid(text: str) -> str:
    return '/' + re.sub(r'\W+', '_', text.strip('/')).strip('_').lstrip('0123456789') if text else '/robot'


def new_file(text: str) -> Path:
    """A file to write, in a folder that exists."""
    path = Path(text)
    if path.is_dir():
        raise argparse.ArgumentTypeError(f'{text!r} is a folder; valid is a file to write')
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f'{text!r} cannot be written: no folder {str(path.parent)!r}')
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f'{text!r} cannot be written: permission denied')
    return path


def folder(text: str) -> Path:
    """A folder to write to, which may be made."""
    path = Path(text)
    there = next(one for one in (path.absolute(), *path.absolute().parents) if one.exists())
    if not there.is_dir():
        raise argparse.ArgumentTypeError(f'{text!r} cannot be written: {str(there)!r} is a file')
    if not os.access(there, os.W_OK | os.X_OK):
        raise argparse.ArgumentTypeError(f'{text!r} cannot be written: {str(there)!r} permits no writing')
    return path


def new_folder(text: str) -> Path:
    """A folder that does not exist."""
    path = folder(text)
    if path.exists():
        raise argparse.ArgumentTypeError(f'{text!r} exists; valid is a folder that does not exist')
    return path


def payload(text: str) -> tuple[float, ...]:
    """Mass, centre of mass and, optionally, inertia of a payload, see `payload_of`."""
    from robots_core.blocks.multibody.payload import payload_of  # noqa: PLC0415  # not to complete options

    try:
        values = tuple(float(part) for part in text.split(','))
        payload_of(values)
    except (ValueError, RobotsError) as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return values


def bag(text: str) -> Path:
    """A recorded bag that exists: a folder or a file, or one at most two folders below."""
    path = Path(text)
    if not exists(path):
        raise argparse.ArgumentTypeError(
            f'{text!r} does not exist; a bag is a folder with metadata.yaml, or a .mcap or .db3 file'
        )
    below: list[Path] = []
    with suppress(OSError):  # of folders that nobody may list
        below = sorted({file.parent for place in PLACES for file in path.glob(place)})
    if path in below or not below:  # what is no bag is explained by its reader
        return path
    if len(below) > 1:
        names = ', '.join(map(str, below[:MOST_BAGS])) + (', ...' if len(below) > MOST_BAGS else '')
        raise argparse.ArgumentTypeError(f'below {text!r} are {len(below)} bags; name one of {names}')
    return below[0]


def add_file(parser: argparse.ArgumentParser, flag: str, text: str, metavar: str = 'FILE') -> None:
    """Add an argument that names something to read, which exists; as an option it may be '' for nothing."""
    what = flag.lstrip('-').replace('-', ' ')

    def existing(path: str) -> str:
        if path and not exists(path):
            raise argparse.ArgumentTypeError(f'{what} {path!r} not found')
        return path

    action = parser.add_argument(flag, type=existing, metavar=metavar, help=text)
    if action.option_strings:
        action.default = ''


def add_number(
    parser: argparse.ArgumentParser,
    flag: str,
    unit: str,
    text: str,
    *,
    default: float | None = None,
    above: float = -math.inf,
    least: float = -math.inf,
) -> None:
    """Add an option that is a finite number, see `number`."""
    kind = number(unit, above=above, least=least)
    parser.add_argument(flag, type=kind, default=default, metavar=METAVARS[unit], help=text)


def add_count(parser: argparse.ArgumentParser, flag: str, text: str, *, default: int, least: int = 0) -> None:
    """Add an option that is a number of things."""
    parser.add_argument(flag, type=whole_number(least), default=default, metavar='COUNT', help=text)


def add_patience(parser: argparse.ArgumentParser) -> None:
    """Add the limit of the time that a command may take."""
    text = 'longest time of this machine that simulating a program may take, s; no limit by default'
    add_number(parser, '--patience', 's', text, above=0.0, default=math.inf)


def add_namespace(parser: argparse.ArgumentParser, whose: str) -> None:
    """Add the namespace of a cell."""
    parser.add_argument('--namespace', type=namespace, default='/', help=f'ROS namespace of {whose}')

"""The folders in which a ROS package may be, for files that name it."""

import os
import re
from pathlib import Path
from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.files.user_file import read_bytes

NAME: Final = re.compile(r'<name>\s*([\w-]+)\s*</name>')


def package_places(package: str, folder: Path) -> list[Path]:
    """Folders of a package, the likeliest first; they need not exist.

    Args:
        package: Its name.
        folder: That of the file that names it: the package is this one or one above it, stands beside one of
            them, or is found by AMENT_PREFIX_PATH or ROS_PACKAGE_PATH.
    """
    above = [folder.resolve(), *folder.resolve().parents]
    places = [parent for parent in above if package in (parent.name, _package_name(parent))]
    places += [parent / package for parent in above]
    places += [prefix / 'share' / package for prefix in _paths('AMENT_PREFIX_PATH')]
    roots = _paths('ROS_PACKAGE_PATH')
    return places + [root for root in roots if root.name == package] + [root / package for root in roots]


def _package_name(folder: Path) -> str:
    """The name that the `package.xml` of a folder states, which a repository's folder need not have."""
    try:
        found = NAME.search(read_bytes(folder / 'package.xml').decode(errors='replace'))
    except InvalidInputError:
        return ''
    return found.group(1) if found else ''


def _paths(variable: str) -> list[Path]:
    return [Path(path) for path in os.environ.get(variable, '').split(os.pathsep) if path]

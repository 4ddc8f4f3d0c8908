"""The mesh files of a URDF."""

import os
from pathlib import Path
from urllib.parse import unquote, urlparse

from lxml import etree

from robots_core.errors import UnknownRobotError


def mesh_path(filename: str, folder: Path) -> Path:
    """The file of a mesh name in a URDF.

    Args:
        filename: A relative or absolute path, `file://` with an absolute path, or
            `package://<package>/<path>`: looked for in the folders above the URDF, then among the
            installed ROS packages.
        folder: Where relative names start.

    Raises:
        UnknownRobotError: no such file, or no file's name.
    """
    try:
        found = next((path for path in _candidates(filename, folder) if path.is_file()), None)
    except (OSError, ValueError) as problem:  # too long, a null character, or no address
        raise UnknownRobotError(f'{filename[:100]!r} names no mesh file: {_cause(problem)}') from None
    if found is None:
        raise UnknownRobotError(f'mesh file {filename!r} not found below {folder}')
    return found


def _cause(problem: OSError | ValueError) -> str:
    return (problem.strerror if isinstance(problem, OSError) else None) or str(problem)


def _candidates(filename: str, folder: Path) -> list[Path]:
    parts = urlparse(filename)
    relative = unquote(parts.path).lstrip('/')
    if parts.scheme == 'file':
        return [Path(unquote(parts.path))]
    if parts.scheme == 'package':
        above = [folder.resolve(), *folder.resolve().parents]
        candidates = [parent / relative for parent in above if parent.name == parts.netloc]
        candidates += [parent / parts.netloc / relative for parent in above]
        prefixes = filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep))
        return candidates + [Path(prefix) / 'share' / parts.netloc / relative for prefix in prefixes]
    return [folder / filename]


def with_absolute_meshes(xml: str, folder: Path) -> str:
    """The URDF text with every mesh named by an absolute `file://` address, which loads from any folder.

    Raises:
        UnknownRobotError: a mesh file that is missing.
    """
    root = etree.fromstring(xml.encode())
    for mesh in root.iter('mesh'):
        mesh.set('filename', mesh_path(str(mesh.get('filename')), folder).resolve().as_uri())
    return str(etree.tostring(root, encoding='unicode'))

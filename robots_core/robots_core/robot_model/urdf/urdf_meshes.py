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
        UnknownRobotError: no such file.
    """
    parts = urlparse(filename)
    relative = unquote(parts.path).lstrip('/')
    if parts.scheme == 'file':
        candidates = [Path(unquote(parts.path))]
    elif parts.scheme == 'package':
        above = [folder.resolve(), *folder.resolve().parents]
        candidates = [parent / relative for parent in above if parent.name == parts.netloc]
        candidates += [parent / parts.netloc / relative for parent in above]
        prefixes = filter(None, os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep))
        candidates += [Path(prefix) / 'share' / parts.netloc / relative for prefix in prefixes]
    else:
        candidates = [folder / filename]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise UnknownRobotError(f'mesh file {filename!r} not found below {folder}')


def with_absolute_meshes(xml: str, folder: Path) -> str:
    """The URDF text with every mesh named by an absolute `file://` address, which loads from any folder.

    Raises:
        UnknownRobotError: a mesh file that is missing.
    """
    root = etree.fromstring(xml.encode())
    for mesh in root.iter('mesh'):
        mesh.set('filename', mesh_path(str(mesh.get('filename')), folder).resolve().as_uri())
    return str(etree.tostring(root, encoding='unicode'))

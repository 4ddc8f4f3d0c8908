"""The mesh files of a URDF."""

from collections.abc import Mapping
from pathlib import Path
from urllib.parse import unquote, urlparse

from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.urdf.package_places import package_places
from robots_core.robot_model.urdf.simple_bodies import replace_shape, simple_body
from robots_core.robot_model.urdf.substitutions import Substitutions


def mesh_path(filename: str, folder: Path) -> Path:
    """The file of a mesh name in a URDF.

    Args:
        filename: A relative or absolute path, `file://` with an absolute path, or
            `package://<package>/<path>`: looked for where `package_places` says, then beside the URDF.
        folder: Where relative names start.

    Raises:
        UnknownRobotError: no such file, or no file's name.
    """
    found = _found(filename, folder)
    if found is None:
        raise UnknownRobotError(
            f'mesh file {filename!r} not found {_searched(filename, folder)}', mesh=filename
        )
    return found


def _found(filename: str, folder: Path) -> Path | None:
    try:
        return next((path for path in _candidates(filename, folder) if path.is_file()), None)
    except (OSError, ValueError) as problem:  # too long, a null character, or no address
        raise UnknownRobotError(
            f'{filename[:100]!r} names no mesh file: {_cause(problem)}', mesh=filename
        ) from None


def _searched(filename: str, folder: Path) -> str:
    packages = ', in AMENT_PREFIX_PATH and ROS_PACKAGE_PATH' if filename.startswith('package:') else ''
    return f'beside or below {folder}{packages}'


def _cause(problem: OSError | ValueError) -> str:
    return (problem.strerror if isinstance(problem, OSError) else None) or str(problem)


def _candidates(filename: str, folder: Path) -> list[Path]:
    parts = urlparse(filename)
    relative = unquote(parts.path).lstrip('/')
    if parts.scheme == 'file':
        return [Path(unquote(parts.path))]
    if parts.scheme == 'package':
        places = package_places(parts.netloc, folder)
        return [*(place / relative for place in places), folder / relative, folder / Path(relative).name]
    return [folder / filename]


def with_absolute_meshes(
    xml: str,
    folder: Path,
    substitutions: Substitutions | None = None,
    *,
    unreadable: UnknownRobotError | None = None,
) -> str:
    """The URDF text with every mesh named by an absolute `file://` address, which loads from any folder.

    A mesh that is missing is replaced by the other mesh of its link, that for display by that for collision
    checks and the other way round; where both are missing, by a simple body (see `simple_body`). Where no
    link has a shape for collision checks, those for display are taken.

    Args:
        xml: The URDF.
        folder: Where relative names start.
        substitutions: Receives what is substituted; without it, missing meshes are refused.
        unreadable: About a mesh whose file is there, its detail `mesh`, and is replaced as if it were not.

    Raises:
        UnknownRobotError: a mesh file that is missing where nothing may be substituted, or no file's name.
    """
    root = etree.fromstring(xml.encode())
    if substitutions is not None:
        _collide_with_what_is_shown(root, substitutions)
    missing: dict[str, list[etree._Element]] = {}
    for link in root.iter('link'):
        lost = [mesh for mesh in link.iter('mesh') if not _made_absolute(mesh, folder, unreadable)]
        if lost and substitutions is None:
            mesh_path(_name(lost[0]), folder)
        missing |= {str(link.get('name')): lost} if lost else {}
    if missing and substitutions is not None:
        _substitute(root, missing, folder, substitutions, unreadable)
    return str(etree.tostring(root, encoding='unicode'))


def _collide_with_what_is_shown(root: etree._Element, substitutions: Substitutions) -> None:
    shown = [(link, visual) for link in root.iter('link') for visual in link.findall('visual')]
    if not shown or next(root.iter('collision'), None) is not None:
        return
    for link, visual in shown:
        replace_shape(etree.SubElement(link, 'collision'), visual)
    substitutions.add('no link has a <collision>', 'what is shown by <visual>')


def _name(mesh: etree._Element) -> str:
    return str(mesh.get('filename'))


def _made_absolute(mesh: etree._Element, folder: Path, unreadable: UnknownRobotError | None) -> bool:
    path = _found(_name(mesh), folder)
    if path is None or (unreadable is not None and str(path) == unreadable.details['mesh']):
        return False
    mesh.set('filename', path.resolve().as_uri())
    return True


def _substitute(
    root: etree._Element,
    missing: Mapping[str, list[etree._Element]],
    folder: Path,
    substitutions: Substitutions,
    unreadable: UnknownRobotError | None,
) -> None:
    swapped: list[str] = []
    bodies: list[str] = []
    for name, lost in missing.items():
        link = next(link for link in root.iter('link') if link.get('name') == name)
        kept = [element for kind in ('visual', 'collision') for element in link.findall(kind)]
        kept = [element for element in kept if not any(mesh in lost for mesh in element.iter('mesh'))]
        for mesh in lost:
            element = next(one for one in link if mesh in list(one.iter('mesh')))
            others = [one for one in kept if one.tag != element.tag]
            if others:
                replace_shape(element, others[0])
            else:
                replace_shape(element, simple_body(root, name))
        (swapped if kept else bodies).append(name)
    example = _name(next(iter(missing.values()))[0])
    lacking = f'there is no mesh file {example!r} {_searched(example, folder)}'
    number = sum(len(lost) for lost in missing.values())
    if unreadable is not None:
        lacking = unreadable.message
    elif number > 1:
        lacking = f'{number} mesh files are missing: {lacking}'
    taken = []
    if swapped:
        taken.append(f'the other mesh of {", ".join(swapped)}')
    if bodies:
        taken.append(f'cylinders and spheres between the joints of {", ".join(bodies)}')
    substitutions.add(lacking, ', and '.join(taken))

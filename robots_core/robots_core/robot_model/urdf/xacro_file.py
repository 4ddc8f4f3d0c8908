"""URDF text from a xacro file, by the package xacro of PyPI or ROS."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from errno import ENOENT
from importlib import import_module
from io import StringIO
from os import strerror
from pathlib import Path
from typing import IO, Any, Final

from robots_core.errors import InvalidInputError, RobotsError, UnknownRobotError
from robots_core.files.user_file import exists, read_text
from robots_core.files.yaml_section import compose_yaml
from robots_core.robot_model.urdf.package_places import package_places
from robots_core.wording.nearest_name import did_you_mean

# `<robot name="$(arg name)">` comes before the argument that gives it a default.
NAME: Final = re.compile(r'<xacro:arg\s+name\s*=\s*["\']name["\'](?:\s+default\s*=\s*["\']([^"\']+)["\'])?')
ARGUMENT: Final = re.compile(r'<xacro:arg\s[^>]*?name\s*=\s*["\']([^"\']+)["\']')
FIND: Final = '_eval_find'  # xacro's private function for $(find ...); it has no public way to replace it


def expanded_xacro(path: Path, arguments: Mapping[str, str]) -> str:
    """The URDF text that a xacro file makes.

    Packages that it finds by `$(find ...)` are those of `package_places`.

    Args:
        path: The file.
        arguments: Values for its `<xacro:arg>`s; one called `name` is the file's name by default.

    Raises:
        UnknownRobotError: xacro is not installed, there is no such file, xacro cannot expand it, or it has no
            argument of such a name.
    """
    try:
        text = read_text(path, 'xacro file')
    except InvalidInputError as error:
        raise UnknownRobotError(error.message, **error.details) from None
    try:
        xacro = import_module('xacro')
        substitution = import_module('xacro.substitution_args')
    except ImportError:
        raise UnknownRobotError(
            f'{path.name} needs the package xacro: pip install xacro; or expand the file elsewhere '
            f'(xacro {path.name} > robot.urdf)'
        ) from None
    urdf, problem = '', None
    if named := NAME.search(text):
        arguments = {'name': named[1] or path.name.partition('.')[0], **arguments}
    try:
        with _packages_found(substitution, path.resolve().parent), _files_checked(xacro):
            urdf = str(xacro.process_file(str(path), mappings=dict(arguments)).toxml())
    except Exception as error:  # noqa: BLE001  # whatever its many steps raise
        cause = getattr(error, 'exc', None)  # xacro writes the message of what it wraps twice
        problem = cause if isinstance(cause, RobotsError) else error
    included = (Path(file) for file in getattr(xacro, 'all_includes', ()))
    known = sorted(
        {*ARGUMENT.findall(text), *(name for file in included for name in declared_arguments(file))}
    )
    listed = f'its arguments are {", ".join(known) or "none"}'
    for name in arguments:
        if name not in known:
            raise UnknownRobotError(
                f'{path.name} has no argument {name!r}{did_you_mean(name, known)}; {listed}'
            )
    if problem is not None:
        raise UnknownRobotError(
            f'{path.name} cannot be expanded by xacro: {str(problem).partition(" [Errno")[0]}; '
            f'{listed}, given as xacro:{path}?name=value'
        ) from problem
    return urdf


def declared_arguments(path: Path) -> set[str]:
    """Names of the arguments that a xacro file itself declares; none of a file that cannot be read."""
    try:
        return set(ARGUMENT.findall(read_text(path, 'xacro file')))
    except InvalidInputError:
        return set()


@contextmanager
def _packages_found(substitution: Any, folder: Path) -> Iterator[None]:
    """Let xacro find packages that are not installed."""

    def find(package: str) -> str:
        places = package_places(package, folder)
        found = next((place for place in places if place.is_dir()), None)
        if found is None:
            raise UnknownRobotError(
                f'package {package!r} is neither above or beside {folder} nor in AMENT_PREFIX_PATH and '
                'ROS_PACKAGE_PATH'
            )
        return str(found)

    original = getattr(substitution, FIND)
    setattr(substitution, FIND, find)
    try:
        yield
    finally:
        setattr(substitution, FIND, original)


@contextmanager
def _files_checked(xacro: Any) -> Iterator[None]:
    """Let xacro read the files that are included, or loaded as YAML, as all files of users are read."""

    def careful_open(path: str) -> IO[str]:
        if not exists(path):
            raise FileNotFoundError(ENOENT, strerror(ENOENT), path)  # which xacro passes over where optional
        text = read_text(path, 'included file')
        if not text.lstrip().startswith('<'):
            compose_yaml(text, Path(path).name)  # refuses what is nested or repeated too often
        return StringIO(text)

    xacro.open = careful_open  # before the function of Python of that name
    try:
        yield
    finally:
        del xacro.open

"""The paper's robotChoice: robots by name, found through entry points."""

import inspect
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final
from urllib.parse import parse_qsl

from robots_core.errors import RobotsError, UnknownRobotError
from robots_core.plugins import ROBOT_MODELS, installed_plugins, load_plugin, plugin_text
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.urdf.xacro_file import declared_arguments
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel
from robots_core.wording.nearest_name import did_you_mean

URDF_PREFIX: Final = 'urdf:'
XACRO_PREFIX: Final = 'xacro:'


def available_robot_models() -> tuple[str, ...]:
    """Names of all installed robots, sorted."""
    return tuple(sorted(installed_plugins(ROBOT_MODELS)))


def load_robot_model(name: str, **options: Any) -> BaseRobotModel:
    """Load a robot.

    Args:
        name: An installed robot's name, or `urdf:/path/to/robot.urdf`. Options may follow as in a web
            address, so that they fit into the parameter of a node: `urdf:/path/robot.urdf?tip=hand`,
            `debris_arm?gravity=0,0,0`. Numbers with commas between them are a vector, `true` and `false`
            truth values, all else is text.
        options: Options by keyword; they go before those in the name. What a robot takes is up to its
            plugin; a URDF takes the options of `UrdfRobotModel`. A xacro file, `xacro:/path/x.urdf.xacro`,
            takes them too, and all others as its own arguments.

    Raises:
        UnknownRobotError: no such robot, two robots of this name, a broken plugin, an option that it does
            not take, or a URDF that is not a serial robot.
        InvalidInputError: an option's value is not valid.
    """
    plain, _, query = name.partition('?')
    texts = _texts(name, query)
    given, options = texts | options, {key: _value(text) for key, text in texts.items()} | options
    if plain.startswith(XACRO_PREFIX):
        return _load_xacro(Path(plain.removeprefix(XACRO_PREFIX)), given, options)
    if plain.startswith(URDF_PREFIX):
        _check_options(plain, UrdfRobotModel, (Path(),), options)
        return UrdfRobotModel(Path(plain.removeprefix(URDF_PREFIX)), **options)
    return _load_plugin(plain, options)


def _load_xacro(path: Path, given: Mapping[str, Any], options: Mapping[str, Any]) -> BaseRobotModel:
    own = set(inspect.signature(UrdfRobotModel).parameters) - declared_arguments(path)
    arguments = {key: str(value) for key, value in given.items() if key not in own}
    mine = {key: value for key, value in options.items() if key in own}
    return UrdfRobotModel(path, xacro_arguments=arguments, **mine)


def _texts(name: str, query: str) -> dict[str, str]:
    try:
        return dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
    except ValueError as error:
        raise UnknownRobotError(f'{name!r}: options look like ?option=value&other=value') from error


def _value(text: str) -> bool | str | tuple[float, ...]:
    if text in ('true', 'false'):
        return text == 'true'
    parts = text.split(',')
    if len(parts) == 1:
        return text
    try:
        return tuple(float(part) for part in parts)
    except ValueError:
        return text


def _load_plugin(name: str, options: dict[str, Any]) -> BaseRobotModel:
    plugins = installed_plugins(ROBOT_MODELS)
    if name not in plugins:
        known = ', '.join(sorted(plugins)) or 'none installed'
        raise UnknownRobotError(
            f'unknown robot {name!r}{did_you_mean(name, plugins)}; robots are: {known}; or '
            'urdf:/path/to/robot.urdf'
        )
    factory = load_plugin(plugins[name], 'robot', UnknownRobotError)
    who = plugin_text(plugins[name][0])
    if not callable(factory):
        raise UnknownRobotError(f'{who} is {type(factory).__name__}, not a class or function')
    _check_options(who, factory, (), options)
    try:
        robot = factory(**options)
    except RobotsError:
        raise
    except Exception as error:  # whatever a third party's robot raises
        raise UnknownRobotError(f'{who} fails: {type(error).__name__}: {error}') from error
    if not isinstance(robot, BaseRobotModel):
        raise UnknownRobotError(f'{who} returns {type(robot).__name__}, not a BaseRobotModel')
    return robot


def _check_options(who: str, factory: Any, arguments: tuple[Any, ...], options: dict[str, Any]) -> None:
    signature = inspect.signature(factory)
    try:
        signature.bind(*arguments, **options)
    except TypeError as error:
        known = list(signature.parameters)[len(arguments) :]
        unknown = next((option for option in options if option not in known), '')
        raise UnknownRobotError(
            f'{who}: {error}{did_you_mean(unknown, known)}; options are: {", ".join(known) or "none"}'
        ) from error

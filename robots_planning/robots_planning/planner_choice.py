"""Planners by name, found through entry points."""

from __future__ import annotations

import contextlib
import inspect
from functools import cache
from typing import TYPE_CHECKING, Final

from robots_core.errors import InvalidInputError
from robots_core.plugins import installed_plugins, load_plugin
from robots_planning.motion_kinds import MOTION_KINDS, MotionKind

if TYPE_CHECKING:
    from robots_planning.motion_settings import MotionSettings
    from robots_planning.trajectory_generators.trajectory_generator import TrajectoryGenerator

ENTRY_POINT_GROUP: Final = 'robots_planning.planners'
AVOIDING: Final = 'collision_free'
"""Plans joint motions with the setting `avoid`."""


def available_planners(setting: str) -> tuple[str, ...]:
    """Names that the setting `joint_planner` or `cartesian_planner` may have, sorted."""
    names = []
    for name in sorted(installed_plugins(ENTRY_POINT_GROUP)):
        with contextlib.suppress(InvalidInputError):  # a broken one is reported when it is named
            if _serves(name, setting):
                names.append(name)
    return tuple(names)


@cache
def load_planner(name: str) -> type[TrajectoryGenerator]:
    """The class of a planner.

    Raises:
        InvalidInputError: no planner has that name, two have, or it is broken.
    """
    # Imported on demand: whoever checks settings alone loads no planner.
    from robots_planning.trajectory_generators.trajectory_generator import TrajectoryGenerator  # noqa: PLC0415

    plugins = installed_plugins(ENTRY_POINT_GROUP)
    if name not in plugins:
        raise InvalidInputError(f'unknown planner {name!r}; planners are {", ".join(sorted(plugins))}')
    planner = load_plugin(plugins[name], 'planner', InvalidInputError)
    if not (inspect.isclass(planner) and issubclass(planner, TrajectoryGenerator)):
        raise InvalidInputError(f'planner {name!r} is {planner!r}, not a class of TrajectoryGenerator')
    known = {kind.name for kind in MOTION_KINDS}
    if not planner.kinds or not known.issuperset(planner.kinds):
        raise InvalidInputError(
            f'planner {name!r} has kinds = {planner.kinds!r}; valid are {", ".join(sorted(known))}'
        )
    return planner


def planner_for(kind: MotionKind, settings: MotionSettings) -> type[TrajectoryGenerator]:
    """The planner of a motion: the one that is set, or the kind's own where that plans no such motion.

    Raises:
        InvalidInputError: neither does.
    """
    name = AVOIDING if settings.avoid and not kind.cartesian else getattr(settings, kind.setting)
    for candidate in filter(None, (name, kind.planner)):
        planner = load_planner(candidate)
        if kind.name in planner.kinds:
            return planner
    raise InvalidInputError(f'{kind.setting} {name!r} plans no {kind.title}')


@cache
def check_planner(value: str, setting: str) -> None:
    """Pass a name that the setting may have.

    Raises:
        InvalidInputError: it may not; names those that it may.
    """
    if value not in installed_plugins(ENTRY_POINT_GROUP) or not _serves(value, setting):
        valid = ', '.join(available_planners(setting))
        raise InvalidInputError(f'unknown {setting} {value!r}; valid are {valid}')


def _serves(name: str, setting: str) -> bool:
    kinds = load_planner(name).kinds
    return any(kind.name in kinds for kind in MOTION_KINDS if kind.setting == setting and not kind.planner)

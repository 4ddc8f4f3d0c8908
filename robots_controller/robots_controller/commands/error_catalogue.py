"""error_catalogue: every kind of error with its code, and what to do about it."""

import argparse
from collections.abc import Iterator

from rich.console import Console

from robots_controller.io.plant.plant_link import LinkError
from robots_controller.pendant.permissions import NotPermittedError
from robots_core import errors
from robots_core.blocks.collision.results import CollisionError
from robots_core.blocks.zones.zone_error import ZoneError
from robots_core.errors import OptionError, RobotsError
from robots_core.exit_codes import ExitCode
from robots_core.ros.lockstep.agenda import LockstepError
from robots_core.wording.nearest_name import did_you_mean
from robots_planning.free_paths.errors import BlockedPostureError, NoFreePathError, SearchCancelledError


def error_catalogue() -> dict[str, type[RobotsError]]:
    """Kinds of errors by code, in order."""
    kinds: list[type[RobotsError]] = [
        *_kinds_of_core(),
        *(CollisionError, ZoneError, NoFreePathError, SearchCancelledError, BlockedPostureError),
        *(LockstepError, LinkError, NotPermittedError),
    ]
    return {kind.code: kind for kind in sorted(kinds, key=lambda kind: kind.code)}


def describe_error(kind: type[RobotsError]) -> str:
    """What errors of a kind are about, in a sentence."""
    return ' '.join((kind.__doc__ or '').partition('\n\n')[0].split())


def explain(options: argparse.Namespace, console: Console) -> int:
    """Print what the errors with a code are about, and what to do; returns an exit code.

    Raises:
        OptionError: no such code.
    """
    catalogue, code = error_catalogue(), options.code.upper()
    if code not in catalogue:
        raise OptionError(f'there is no error {options.code!r}{did_you_mean(code, catalogue)}')
    kind = catalogue[code]
    console.print(f'{code} {kind.__name__}: {describe_error(kind)}\n{kind.remedy}', markup=False)
    return ExitCode.OK


def _kinds_of_core() -> Iterator[type[RobotsError]]:
    for kind in vars(errors).values():
        if isinstance(kind, type) and issubclass(kind, RobotsError) and kind is not RobotsError:
            yield kind

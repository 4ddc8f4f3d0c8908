"""Operating modes of a robot cell, and the commanders that each permits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from robots_core.blocks.following.guide import Guide
from robots_core.errors import CommandRefusedError
from robots_core.wording.named_choice import NamedChoice


class Commander(NamedChoice):
    """Commanders of a robot, one at a time."""

    NOBODY = 'NOBODY'
    PROGRAM = 'PROGRAM'
    """A robot program."""
    PENDANT = 'PENDANT'
    """A person who jogs."""
    REMOTE = 'REMOTE'
    """Motion commands on topics, from other nodes than the program's."""
    SENSOR = 'SENSOR'
    """Reference poses and twists."""


class OperatingMode(NamedChoice):
    """How the cell is operated."""

    AUTOMATIC = 'AUTOMATIC'
    T1 = 'T1'
    T2 = 'T2'
    REMOTE = 'REMOTE'


@dataclass(frozen=True)
class ModeRules:
    """What holds in an operating mode.

    Attributes:
        commanders: They may command the robot.
        tool_speed_limit: Of the tool and the frames of all axes on every motion, m/s; 0 for none.
        held: Motions of programs continue only while run is held.
        purpose: What the mode is for, for a person.
    """

    commanders: tuple[Commander, ...]
    tool_speed_limit: float
    held: bool
    purpose: str


MODES: Final[Mapping[OperatingMode, ModeRules]] = {
    OperatingMode.AUTOMATIC: ModeRules(
        (Commander.PROGRAM, Commander.REMOTE, Commander.SENSOR),
        tool_speed_limit=0.0,
        held=False,
        purpose='production: programs run by themselves; a person jogs only where the program says so',
    ),
    OperatingMode.T1: ModeRules(
        (Commander.PROGRAM, Commander.PENDANT),
        tool_speed_limit=0.25,
        held=True,
        purpose='teaching and first tests: a person jogs, and runs programs slowly while holding run',
    ),
    OperatingMode.T2: ModeRules(
        (Commander.PROGRAM, Commander.PENDANT),
        tool_speed_limit=0.0,
        held=True,
        purpose='tests at the programmed speed, while a person holds run',
    ),
    OperatingMode.REMOTE: ModeRules(
        (Commander.REMOTE, Commander.SENSOR),
        tool_speed_limit=0.0,
        held=False,
        purpose='other nodes command the motions; no programs',
    ),
}
"""By mode."""

GUIDING: Final[Mapping[Guide, Commander]] = {
    Guide.SENSOR: Commander.SENSOR,
    Guide.PERSON: Commander.PENDANT,
}
"""Commanders that a program lets guide its robot."""


def check_command(
    sender: Commander,
    *,
    commander: Commander,
    mode: OperatingMode | None,
    guide: Guide = Guide.NONE,
) -> None:
    """Check that a commander may command the robot now.

    Args:
        sender: Where the command comes from.
        commander: The present commander.
        mode: The cell's operating mode; None where no controller publishes one.
        guide: What the program lets guide its robot.

    Raises:
        CommandRefusedError: another one commands the robot, or the mode excludes the sender.
    """
    if GUIDING.get(guide) is sender and commander in (Commander.PROGRAM, Commander.NOBODY):
        return
    check_mode(sender, mode)
    if commander not in (sender, Commander.NOBODY):
        raise CommandRefusedError(
            f'{commander} commands the robot, not {sender}; '
            f'{sender} takes it over by controller_node/take_over/{sender.lower()}',
            commander=commander.value,
        )


def sensor_guides(*, commander: Commander, mode: OperatingMode | None, guide: Guide | None) -> bool:
    """The robot follows reference poses and twists now.

    Args:
        commander: The present commander.
        mode: The cell's operating mode; None where no controller publishes one.
        guide: What the program lets guide its robot; None without a program's node.
    """
    if commander is not Commander.SENSOR and guide not in (None, Guide.SENSOR):
        return False
    try:
        check_command(Commander.SENSOR, commander=commander, mode=mode, guide=guide or Guide.NONE)
    except CommandRefusedError:
        return False
    return True


def check_mode(sender: Commander, mode: OperatingMode | None) -> None:
    """Check that a commander may command the robot in an operating mode, where one is known.

    Raises:
        CommandRefusedError: it may not.
    """
    if mode is not None and sender not in MODES[mode].commanders:
        valid = [other for other, rules in MODES.items() if sender in rules.commanders]
        raise CommandRefusedError(
            f'{sender} does not command the robot in operating mode {mode}, but in {", ".join(valid)}',
            mode=mode.value,
        )

"""ExitCode: how commands and nodes end."""

from collections.abc import Mapping
from enum import IntEnum
from types import MappingProxyType
from typing import Final


class ExitCode(IntEnum):
    """What a command or node reports to the shell that started it."""

    OK = 0
    FAILED = 1
    BAD_INPUT = 2
    INTERRUPTED = 130


MEANINGS: Final[Mapping[ExitCode, str]] = MappingProxyType(
    {
        ExitCode.OK: 'all went well; of a node: it was ended by Ctrl-C or terminate',
        ExitCode.FAILED: (
            'the command did its work, and the result is bad: the program failed or took longer than '
            '`--patience`, a target was missed, a limit was broken, problems or differences were found, or a '
            'node died'
        ),
        ExitCode.BAD_INPUT: 'an option, a name or a file is not valid; nothing was started',
        ExitCode.INTERRUPTED: 'a command was ended by Ctrl-C',
    }
)
"""What each means, for the documentation."""

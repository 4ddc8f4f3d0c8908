"""ExitCode: how commands and nodes end."""

from enum import IntEnum


class ExitCode(IntEnum):
    """What a command or node reports to the shell that started it; see `docs/reference/commands.md`."""

    OK = 0
    FAILED = 1
    BAD_INPUT = 2
    INTERRUPTED = 130

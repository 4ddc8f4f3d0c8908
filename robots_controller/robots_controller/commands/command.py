"""Command: one command of a shell, with its options, its work and its end."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

from robots_core.errors import OptionError, RobotsError, UnreadableFileError
from robots_core.exit_codes import ExitCode
from robots_core.process_end import end_quickly
from robots_core.wording.nearest_name import did_you_mean

if TYPE_CHECKING:  # whatever completes a command line in a shell must be quick
    from rich.console import Console

COMPLETING = '_ARGCOMPLETE'
"""Set in the environment by a shell that asks how a command line goes on."""


class CommandParser(argparse.ArgumentParser):
    """A parser that refuses what is not valid by a `RobotsError`, with the nearest name."""

    def error(self, message: str) -> NoReturn:
        """Refuse the arguments.

        Raises:
            OptionError: always.
        """
        raise OptionError(f'{message.removeprefix("argument ")} ({self.prog} --help lists all options)')

    def parse_all(self, arguments: Sequence[str]) -> argparse.Namespace:
        """Parse all arguments.

        Raises:
            OptionError: one is unknown, missing or not valid.
        """
        options, unknown = self.parse_known_args(arguments)
        if unknown:
            name = unknown[0].partition('=')[0]
            near = did_you_mean(name, self._option_string_actions) if name.startswith('-') else ''
            self.error(f'{unknown[0]!r} is not an option or argument of {self.prog}{near}')
        return options


@dataclass(frozen=True)
class Command:
    """A command.

    Attributes:
        name: Its name.
        what: What it does, for help and documentation.
        add_arguments: Adds its arguments to a parser; loads nothing that takes long.
        function: `module:function` that does its work: takes the options and a console, returns an exit code.
        json: It prints a table, or with --json a document; all else then goes to the standard error.
    """

    name: str
    what: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    function: str
    json: bool = False

    def parser(self, prog: str = '') -> CommandParser:
        """The parser of its command line; `prog` is how it was called, by default its name."""
        what = f'{self.what[0].upper()}{self.what[1:]}.'
        parser = CommandParser(prog=prog or self.name, description=what)
        self.add_all(parser)
        return parser

    def add_all(self, parser: argparse.ArgumentParser) -> None:
        """Add its arguments to a parser."""
        self.add_arguments(parser)
        if self.json:
            parser.add_argument('--json', action='store_true', help='print JSON in the place of tables')

    def run(self, arguments: Sequence[str], prog: str = '') -> int:
        """Run it; what is wrong with the input is said in one line.

        Returns:
            Its exit code.
        """
        parser = self.parser(prog)
        return run_with_console(lambda console: self._work(parser.parse_all(arguments), console))

    def _work(self, options: argparse.Namespace, console: Console) -> int:
        module, _, function = self.function.partition(':')
        work: Callable[[argparse.Namespace, Console], int] = getattr(import_module(module), function)
        console.stderr = self.json and options.json
        return work(options, console)

    def main(self) -> NoReturn:
        """Run it from the command line, or complete that for a shell."""
        if COMPLETING in os.environ:
            complete(self.parser())
        sys.exit(self.run(sys.argv[1:]))


def complete(parser: argparse.ArgumentParser) -> None:
    """Print how a command line goes on, and end."""
    import argcomplete  # noqa: PLC0415  # when a shell asks

    argcomplete.autocomplete(parser)


def run_with_console(run: Callable[[Console], int]) -> int:
    """Run with a console; what is wrong with the input, and Ctrl-C, end it with codes of their own."""
    end_quickly()
    try:
        from rich.console import Console  # noqa: PLC0415  # not to complete a command line

        return run(Console(highlight=False, soft_wrap=True))
    except RobotsError as error:
        print(error.line_for_person, file=sys.stderr)
        return ExitCode.BAD_INPUT
    except OSError as error:
        if error.filename is None:  # not of a path that a person has given
            raise
        refused = UnreadableFileError(f'{error.filename} cannot be used: {error.strerror}')
        print(refused.line_for_person, file=sys.stderr)
        return ExitCode.BAD_INPUT
    except KeyboardInterrupt:
        return ExitCode.INTERRUPTED

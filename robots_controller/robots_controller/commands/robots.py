"""robots: the command below which all others are found."""

import os
import sys
from collections.abc import Sequence
from typing import Final, NoReturn

from robots_controller.commands.command import COMPLETING, CommandParser, complete, run_with_console
from robots_controller.commands.command_table import ABOUT_ROBOTS, TOOLS
from robots_core.exit_codes import ExitCode
from robots_core.wording.nearest_name import did_you_mean

NAME: Final = 'robots'
WHAT: Final = 'has all commands below it: `robots list`, `robots simulate ...`'
COMMANDS: Final = {command.name: command for command in (*ABOUT_ROBOTS, *TOOLS)}
SHELLS: Final = ('bash', 'zsh', 'fish')


def main() -> NoReturn:
    """Run from the command line, or complete that for a shell."""
    if COMPLETING in os.environ:
        complete(_parser())
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Run the command that the first argument names with the others; returns its exit code."""
    name, *others = arguments or ['--help']
    if name in COMMANDS:
        return COMMANDS[name].run(others, prog=f'{NAME} {name}')
    return run_with_console(lambda _: _run_without_command(arguments or ['--help']))


def _run_without_command(arguments: Sequence[str]) -> int:
    name = arguments[0]
    parser = _parser()
    if not name.startswith('-'):
        near = did_you_mean(name, COMMANDS)
        parser.error(f'there is no command {name!r}{near}; commands are {", ".join(COMMANDS)}')
    options = parser.parse_all(arguments)
    if options.completion:
        from argcomplete.shell_integration import shellcode  # noqa: PLC0415  # for this alone

        names = [NAME, *(command.name for command in TOOLS)]
        print(shellcode(names, shell=options.completion))
    return ExitCode.OK


def _parser() -> CommandParser:
    """The parser of all commands, for their list and for completion."""
    parser = CommandParser(
        prog=NAME, description='Simulate and control serial robots.', epilog='robots COMMAND --help explains.'
    )
    parser.add_argument(
        '--completion',
        choices=SHELLS,
        help='print what completes commands in a shell: eval "$(robots --completion bash)"',
    )
    commands = parser.add_subparsers(title='commands', metavar='COMMAND', parser_class=CommandParser)
    for command in COMMANDS.values():
        command.add_all(commands.add_parser(command.name, help=command.what))
    return parser


if __name__ == '__main__':
    main()

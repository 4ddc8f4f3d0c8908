"""Rows of the documentation that follow from tables in code: motion commands and functions of programs."""

import re
from pathlib import Path
from typing import Final

from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_core.cell_interface.topic_qos import topic_qos
from robots_planning.motion_kinds import MOTION_KINDS

REFERENCE: Final = Path('docs/reference')
_COMMANDS: Final = re.compile(r'(?:^\|.*\| command: .*\|\n)+', re.MULTILINE)
_FUNCTIONS: Final = re.compile(
    r'(?<=\| function \| what it does \| returns \|\n\|---\|---\|---\|\n)(?:\|.*\n)+'
)


def topics_page(page: str) -> str:
    """The page of topics with a row for each motion command."""
    rows = (
        f'| `{kind.topic}` | {kind.message_type.replace("/msg", "")} | {topic_qos(kind.topic).text} | anyone '
        f'| command: {kind.what} |\n'
        for kind in MOTION_KINDS
    )
    return _COMMANDS.sub(lambda _: ''.join(rows), page)


def programs_page(page: str) -> str:
    """The page of robot programs with a row for each function."""
    rows = (f'| `{one.signature}` | {one.doc} | {one.result or "-"} |\n' for one in LUA_FUNCTIONS.values())
    return _FUNCTIONS.sub(lambda _: ''.join(rows), page)


PAGES: Final = {'topics.md': topics_page, 'robot_programs.md': programs_page}
"""By their names in `REFERENCE`."""


def write_pages(reference: Path = REFERENCE) -> None:
    """Renew the rows."""
    for name, renewed in PAGES.items():
        page = reference / name
        page.write_text(renewed(page.read_text('utf-8')), 'utf-8')

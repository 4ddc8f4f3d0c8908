"""The file and the line of a URDF that an error is about."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import PurePath

from lxml import etree

from robots_core.errors import RobotsError


def line_of(element: etree._Element) -> dict[str, int]:
    """The details of an error about an element that was read from a text: its line."""
    return {} if element.sourceline is None else {'line': element.sourceline}


@contextmanager
def placed_in(file: str, xml: str, *, expanded: bool = False) -> Iterator[None]:
    """Begin errors that are raised meanwhile with the file and, where it is known, the line.

    Errors that name a file of their own pass as they are. The lines of a file are not known if the text was
    expanded from it.
    """
    try:
        yield
    except RobotsError as error:
        if 'file' in error.details:
            raise
        line = error.details.pop('line', None) or _line_of_mesh(xml, error.details.get('mesh'))
        place = f'{file}:{line}' if line and not expanded else file
        error.details |= {'file': file, 'line': line} if line and not expanded else {'file': file}
        error.message = f'{place}: {error.message}'
        error.args = (error.message,)
        raise


def _line_of_mesh(xml: str, mesh: str | float | None) -> int | None:
    if mesh is None:
        return None
    name = PurePath(str(mesh)).name
    found = (element for element in etree.fromstring(xml.encode()).iter('mesh'))
    return next((one.sourceline for one in found if PurePath(one.get('filename', '')).name == name), None)

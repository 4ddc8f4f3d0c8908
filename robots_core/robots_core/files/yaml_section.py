"""YamlSection: a YAML file whose mistakes are reported with file and line."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final, TypeVar

import yaml
from yaml.constructor import ConstructorError

from robots_core.errors import FileContentError, InvalidInputError, RobotsError
from robots_core.files.user_file import read_text
from robots_core.wording.nearest_name import nearest_name

MAX_NODES: Final = 1_000_000
SHORT: Final = 10_000  # characters
# By what the parser says of a text that is not YAML.
REMEDIES: Final = {
    "'\\t'": 'indent by spaces, not by tabs',
    'expected <block end>': 'what belongs together begins in the same column',
    'mapping values are not allowed': 'what belongs together begins in the same column, and a text with a '
    'colon stands in quotation marks',
    "could not find expected ':'": 'a line is key: value, with a space behind the colon',
    "expected ',' or": 'a bracket is not closed, or a comma is missing',
    'unexpected end of stream': 'a quotation mark is not closed',
}
Made = TypeVar('Made')


class YamlSection:
    """One mapping of a YAML file: its keys are read once each, and `finish` refuses those that were not.

    Args:
        file: The file's name, for errors.
        node: The mapping.
    """

    def __init__(self, file: str, node: yaml.MappingNode) -> None:
        self.file = file
        self.line = node.start_mark.line + 1
        self._nodes: dict[str, tuple[yaml.Node, yaml.Node]] = {}
        self._read: list[str] = []
        self._below: list[YamlSection] = []
        for key, value in node.value:
            name = str(key.value)
            if name in self._nodes:
                first = self._nodes[name][0].start_mark.line + 1
                raise self.error(f'{name!r} stands here and in line {first}', node=key)
            self._nodes[name] = (key, value)

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys, in the file's order, as they are written."""
        return tuple(self._nodes)

    def __contains__(self, key: str) -> bool:
        return key in self._nodes

    def line_of(self, key: str) -> int:
        """The line of a key; the section's own for one that is missing."""
        return self._nodes[key][0].start_mark.line + 1 if key in self._nodes else self.line

    def error(self, message: str, key: str = '', *, node: yaml.Node | None = None) -> InvalidInputError:
        """The error to raise, at a key or at the section."""
        line = self.line_of(key) if node is None else node.start_mark.line + 1
        return located(self.file, line, message)

    def missing(self, key: str, what: str = '') -> InvalidInputError:
        """The error to raise for a key that is needed, at one that is misspelled if there is such a one.

        Args:
            key: It.
            what: What it says, for a person.
        """
        others = [other for other in self._nodes if other not in self._read]
        close = nearest_name(key, others)
        if close is not None:
            return self.error(f'unknown key {close!r}; did you mean {key!r}?', close)
        return self.error(f'{key} is missing{what and f": {what}"}', key)

    # -- values -----------------------------------------------------------------------------------

    def text(self, key: str, default: str | None = None, *, among: Collection[str] = ()) -> str:
        """A text; a number or a switch counts as its text.

        Raises:
            InvalidInputError: missing without a default, not a single value, or not `among` the valid ones.
        """
        node = self._take(key, needed=default is None)
        if node is None:
            assert default is not None
            return default
        if not isinstance(node, yaml.ScalarNode):
            raise self.error(f'{key} must be a text', key)
        text = str(node.value)
        if among and text not in among:
            raise self.error(f'{key} is {text!r}; valid are {", ".join(among)}', key)
        return text

    def number(
        self, key: str, default: float | None = None, *, low: float = -math.inf, high: float = math.inf
    ) -> float:
        """A finite number in [low, high].

        Raises:
            InvalidInputError: missing without a default, or another value.
        """
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise self.error(f'{key} is {value!r}; valid is a finite number', key)
        if not low <= value <= high:
            bounds = f'at least {low:g}' if high == math.inf else f'in [{low:g}, {high:g}]'
            raise self.error(f'{key} is {value!r}; valid is a number {bounds}', key)
        return value

    def whole(self, key: str, default: int | None = None, *, low: int, high: int) -> int:
        """A whole number in low..high.

        Raises:
            InvalidInputError: missing without a default, or another value.
        """
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise self.error(f'{key} is {value!r}; valid is a whole number in {low}..{high}', key)
        return value

    def switch(self, key: str, default: bool | None = None) -> bool:  # noqa: FBT001
        """True or false, or 1 or 0.

        Raises:
            InvalidInputError: missing without a default, or another value.
        """
        value = self._value(key, default)
        if value not in (True, False):  # 1 and 0 are equal to these
            raise self.error(f'{key} is {value!r}; valid are true and false', key)
        return bool(value)

    def made(self, key: str, make: Callable[[Any], Made]) -> Made:
        """What `make` returns for the value, whatever its type.

        Raises:
            InvalidInputError: missing, or `make` has raised a RobotsError.
        """
        value = self._value(key, None)
        return self.checked(lambda: make(value), key)

    def section(self, key: str) -> YamlSection | None:
        """A mapping below a key; None if the key is missing.

        Raises:
            InvalidInputError: not a mapping.
        """
        node = self._take(key, needed=False)
        return None if node is None else self._section(node, key)

    def needed_section(self, key: str) -> YamlSection:
        """A mapping below a key.

        Raises:
            InvalidInputError: the key is missing, or not a mapping.
        """
        below = self.section(key)
        if below is None:
            raise self.error(f'{key} is missing')
        return below

    def checked(self, make: Callable[[], Made], key: str = '') -> Made:
        """What `make` returns.

        Raises:
            InvalidInputError: `make` has raised a RobotsError; with the line of the key, or the section's.
        """
        try:
            return make()
        except RobotsError as error:
            raise self.error(error.message, key) from error

    def entries(self, key: str) -> list[tuple[YamlSection, str]]:
        """The keys of a mapping below a key, each with the mapping; none if the key is missing.

        Raises:
            InvalidInputError: not a mapping.
        """
        below = self.section(key)
        return [] if below is None else [(below, name) for name in below.keys]

    def sections(self, key: str) -> Iterator[YamlSection]:
        """A list of mappings below a key; none if the key is missing or empty.

        Raises:
            InvalidInputError: not a list of mappings.
        """
        node = self._take(key, needed=False)
        for item in [] if node is None else self._items(node, key):
            yield self._section(item, f'an item of {key}')

    def texts(self, key: str) -> list[tuple[str, int]]:
        """One text or a list of texts, each with its line; none if the key is missing.

        Raises:
            InvalidInputError: another value.
        """
        node = self._take(key, needed=False)
        if node is None:
            return []
        items = [node] if isinstance(node, yaml.ScalarNode) else self._items(node, key)
        for item in items:
            if not isinstance(item, yaml.ScalarNode):
                raise self.error(f'{key} must be texts', node=item)
        return [(str(item.value), item.start_mark.line + 1) for item in items]

    def values(self, key: str) -> list[tuple[Any, int]]:
        """A list of values of any type, each with its line; none if the key is missing or empty.

        Raises:
            InvalidInputError: not a list.
        """
        node = self._take(key, needed=False)
        items = [] if node is None else self._items(node, key)
        return [(yaml_value(item, self.file), item.start_mark.line + 1) for item in items]

    def finish(self, valid: Collection[str] = ()) -> None:
        """Refuse keys that were not read, here and in the mappings below.

        Args:
            valid: Further keys that the message names.

        Raises:
            InvalidInputError: there is one.
        """
        for below in self._below:
            below.finish()
        for key in self._nodes:
            if key not in self._read:
                known = list(dict.fromkeys([*self._read, *valid]))
                close = get_close_matches(key, known, 1)
                hint = f'did you mean {close[0]!r}?' if close else f'valid are {", ".join(known)}'
                raise self.error(f'unknown key {key!r}; {hint}', key)

    def _take(self, key: str, *, needed: bool) -> yaml.Node | None:
        if key not in self._read:
            self._read.append(key)
        if key in self._nodes:
            return self._nodes[key][1]
        if needed:
            raise self.missing(key)
        return None

    def _value(self, key: str, default: Any) -> Any:
        node = self._take(key, needed=default is None)
        if node is None:
            return default
        return yaml_value(node, self.file)

    def _items(self, node: yaml.Node, key: str) -> list[yaml.Node]:
        if isinstance(node, yaml.SequenceNode):
            return list(node.value)
        if isinstance(node, yaml.ScalarNode) and node.tag == 'tag:yaml.org,2002:null':
            return []
        raise self.error(f'{key} must be a list', node=node)

    def _section(self, node: yaml.Node, what: str) -> YamlSection:
        if not isinstance(node, yaml.MappingNode):
            raise self.error(f'{what} must be a mapping (key: value)', node=node)
        self._below.append(YamlSection(self.file, node))
        return self._below[-1]


def read_yaml(path: Path | str) -> YamlSection:
    """The mapping that a YAML file is.

    Raises:
        InvalidInputError: no file, not YAML, or not a mapping; with its line.
    """
    return parse_yaml(read_text(path), Path(path).name)


def read_yaml_data(path: Path | str, what: str = 'file') -> Any:
    """What a YAML file holds, as lists, mappings and scalars of Python; None for an empty file.

    Raises:
        InvalidInputError: no file, or not YAML; with its line.
    """
    file = Path(path).name
    node = compose_yaml(read_text(path, what), file)
    return None if node is None else yaml_value(node, file)


def yaml_value(node: yaml.Node, file: str) -> Any:
    """A node as lists, mappings and scalars of Python.

    Raises:
        InvalidInputError: a tag or a key that such values do not have; with its line.
    """
    try:
        return _Constructor().construct_document(node)
    except (ConstructorError, ValueError, TypeError) as error:
        reason = error.problem if isinstance(error, ConstructorError) else error
        raise located(file, node.start_mark.line + 1, f'not valid: {reason}') from None


class _Constructor(yaml.constructor.SafeConstructor):
    """Without whole numbers that no float holds, on which calculations would fail."""


def _whole_number(constructor: Any, node: yaml.ScalarNode) -> int:
    value = int(constructor.construct_yaml_int(node))
    if abs(value) > sys.float_info.max:
        raise ConstructorError(problem=f'a number of {len(str(node.value))} characters is too large')
    return value


_Constructor.add_constructor('tag:yaml.org,2002:int', _whole_number)


def parse_yaml(text: str, file: str) -> YamlSection:
    """The mapping that a YAML text is.

    Args:
        text: The text.
        file: Its name, for errors.

    Raises:
        InvalidInputError: not YAML, or not a mapping; with its line.
    """
    node = compose_yaml(text, file)
    if not isinstance(node, yaml.MappingNode):
        raise located(file, 1, 'the file must be a mapping (key: value)')
    return YamlSection(file, node)


def compose_yaml(text: str, file: str) -> yaml.Node | None:
    """The nodes of a YAML text, each with its line; None if it is empty.

    Raises:
        InvalidInputError: not YAML, nested too deeply, or aliases that stand for more than a file holds.
    """
    # LibYAML takes a tenth of the time. It nests without end, which short texts cannot; what is wrong with a
    # text, the parser in Python says.
    if len(text) <= SHORT:
        with suppress(yaml.YAMLError, RecursionError):
            return _checked(yaml.compose(text, Loader=getattr(yaml, 'CSafeLoader', yaml.SafeLoader)), file)
    try:
        return _checked(yaml.compose(text, Loader=yaml.SafeLoader), file)
    except (yaml.YAMLError, RecursionError) as error:
        raise _not_yaml(file, error) from None


def _checked(node: yaml.Node | None, file: str) -> yaml.Node | None:
    if node is not None and _expanded_size(node, {}) > MAX_NODES:
        raise located(file, 1, f'not YAML of this suite: its aliases stand for over {MAX_NODES} values')
    return node


def _expanded_size(node: yaml.Node, known: dict[int, float]) -> float:
    """Number of nodes with every alias in full; infinite where a node contains itself."""
    if isinstance(node, yaml.ScalarNode):
        return 1
    if id(node) not in known:
        known[id(node)] = math.inf
        listed = isinstance(node, yaml.SequenceNode)
        values = node.value if listed else [part for pair in node.value for part in pair]
        known[id(node)] = 1 + sum(_expanded_size(value, known) for value in values)
    return known[id(node)]


def _not_yaml(file: str, error: Exception) -> InvalidInputError:
    if isinstance(error, yaml.MarkedYAMLError):
        mark = error.problem_mark or error.context_mark
        return located(
            file, 1 if mark is None else mark.line + 1, f'not YAML: {error.problem}{_remedy(error.problem)}'
        )
    reason = 'nested too deeply' if isinstance(error, RecursionError) else str(error).replace('\n', ' ')
    return located(file, 1, f'not YAML: {reason}')


def _remedy(problem: str | None) -> str:
    return next((f'; {remedy}' for words, remedy in REMEDIES.items() if words in (problem or '')), '')


def located(file: str, line: int, message: str, **details: str | float) -> FileContentError:
    """An error with file and line, in its text and in its details."""
    return FileContentError(f'{file}:{line}: {message}', file=file, line=line, **details)

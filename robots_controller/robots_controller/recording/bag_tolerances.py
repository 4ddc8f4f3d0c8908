"""BagTolerances: how far a recorded bag may be from the expected one, read from YAML."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from types import MappingProxyType
from typing import Final, Literal, get_args

from robots_core.files.yaml_section import YamlSection, read_yaml

Mode = Literal['sequence', 'changes', 'samples', 'ignore']
LONGEST_TIME: Final = 1e9  # s


@dataclass(frozen=True)
class TopicTolerance:
    """Of one topic.

    Attributes:
        mode: sequence: message by message. changes: the same without repeated messages, for state.
            samples: each expected message has a recorded one at about its time, for streams. ignore.
        time: How far apart in time, s.
        absolute: How far apart two numbers may be; with `relative` the larger one counts.
        relative: The same as a part of the expected number.
        fields: Per path of a field (`position[*]`, `values.id`) its absolute tolerance; None to ignore it.
    """

    mode: Mode = 'sequence'
    time: float = 0.1
    absolute: float = 0.0
    relative: float = 0.0
    fields: tuple[tuple[str, float | None], ...] = ()

    def of_field(self, path: str) -> float | None:
        """The absolute tolerance of a field; None to ignore it. The last pattern that fits counts."""
        for pattern, tolerance in reversed(self.fields):
            # Brackets are letters of paths, not sets of letters.
            literal = pattern.replace('[', '[[]')
            if any(fnmatchcase(path, f'{literal}{below}') for below in ('', '.*', '[[]*')):
                return tolerance
        return self.absolute


@dataclass(frozen=True)
class BagTolerances:
    """Of a whole bag.

    Attributes:
        default: Of topics that are not named; their mode is 'changes' where they latch.
        topics: By name or pattern; the last one that fits counts.
        align: The topic whose first message is time zero; '' for the first message that is compared and
            not latched.
    """

    default: TopicTolerance = field(default_factory=TopicTolerance)
    topics: Mapping[str, TopicTolerance] = field(default_factory=lambda: MappingProxyType({}))
    align: str = ''

    def of_topic(self, topic: str, *, latched: bool) -> TopicTolerance:
        """Tolerance of a topic."""
        for pattern, tolerance in reversed(tuple(self.topics.items())):
            if fnmatchcase(topic, pattern) or fnmatchcase(topic, f'/{pattern}'):
                return tolerance
        if latched and self.default.mode == 'sequence':
            return replace(self.default, mode='changes')
        return self.default


def read_tolerances(path: Path | str) -> BagTolerances:
    """The tolerances of a YAML file.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    section = read_yaml(path)
    below = section.section('default')
    default = _tolerance(below, TopicTolerance()) if below else TopicTolerance()
    # First, so that a topic that is named is compared although all others are ignored.
    named = {text: TopicTolerance(mode='ignore') for text, _ in section.texts('ignore')}
    for topics, name in section.entries('topics'):
        named[name] = _tolerance(topics.needed_section(name), default)
    align = section.text('align', '')
    section.finish()
    return BagTolerances(default, MappingProxyType(named), align)


def _tolerance(section: YamlSection, default: TopicTolerance) -> TopicTolerance:
    modes: dict[str, Mode] = {mode: mode for mode in get_args(Mode)}
    fields = tuple((path, _field(below, path)) for below, path in section.entries('fields'))
    return TopicTolerance(
        mode=modes[section.text('mode', default.mode, among=modes)],
        time=section.number('time', default.time, low=0.0, high=LONGEST_TIME),
        absolute=section.number('absolute', default.absolute, low=0.0),
        relative=section.number('relative', default.relative, low=0.0),
        fields=default.fields + fields,
    )


def _field(section: YamlSection, path: str) -> float | None:
    if section.text(path) == 'ignore':
        return None
    return section.number(path, low=0.0)

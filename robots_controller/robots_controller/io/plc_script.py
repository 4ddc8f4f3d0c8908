"""PlcScript: what a scripted PLC does when outputs and inputs change, read from YAML."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final, Literal

from robots_controller.io.channel_declarations import ChannelDeclarations, read_declarations
from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import channel_at, value_at
from robots_core.files.yaml_section import YamlSection, located, read_yaml

LONGEST_TIME: Final = 86400.0  # s
SHORTEST_PERIOD: Final = 0.001  # s

_EVENT: Final = re.compile(r'(\S+) +(?:(rises|falls|changes)|(above|below) +(\S+))')
_CONDITION: Final = re.compile(r'(\S+) +(?:is +(on|off)|(above|below) +(\S+))')
_EVERY: Final = re.compile(r'every +(\S+) +s')


@dataclass(frozen=True)
class Comparison:
    """Something that is true or false of a channel's value.

    Attributes:
        relation: 'above' or 'below' the bound, 'is' on or off, or 'changes' for any event of a digital one.
        bound: Number to compare with; 1 or 0 for 'is'.
    """

    channel: Channel
    relation: Literal['above', 'below', 'is', 'changes']
    bound: float = 0.0

    def holds(self, value: float) -> bool:
        """True of this value."""
        if self.relation == 'above':
            return value > self.bound
        if self.relation == 'below':
            return value < self.bound
        return self.relation == 'is' and value == self.bound

    def occurs(self, before: float, now: float) -> bool:
        """It becomes true with this change."""
        if self.relation == 'changes':
            return before != now
        return self.holds(now) and not self.holds(before)


@dataclass(frozen=True)
class PlcRule:
    """When something happens, set inputs after some time.

    Attributes:
        event: What triggers the rule; None for the start.
        period: Triggers again and again, s; infinite for a rule with an event.
        conditions: All must hold when the rule is triggered.
        after: Time from the trigger to the setting, s.
        settings: Inputs and their new values.
        duration: After which the inputs get back the values that they had, s; infinite for never.
    """

    event: Comparison | None
    period: float
    conditions: tuple[Comparison, ...]
    after: float
    settings: tuple[tuple[Channel, float], ...]
    duration: float
    line: int


@dataclass(frozen=True)
class PlcScript(ChannelDeclarations):
    """All rules of a file, and its declarations.

    Attributes:
        rules: In the file's order.
        initial: Inputs that do not start at 0.
    """

    rules: tuple[PlcRule, ...]
    initial: Mapping[Channel, float] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Every channel that the script reads or sets, in order of name."""
        found = {*self.initial, *self.signals.values()}
        for rule in self.rules:
            found |= {comparison.channel for comparison in rule.conditions}
            found |= {channel for channel, _ in rule.settings}
            found |= {rule.event.channel} if rule.event else set()
        return tuple(sorted(found, key=lambda channel: (channel.image, channel.index)))

    @property
    def inputs(self) -> tuple[Channel, ...]:
        """The inputs that the script sets or starts with."""
        written = {*self.initial, *(channel for rule in self.rules for channel, _ in rule.settings)}
        return tuple(channel for channel in self.channels if channel in written)


def read_plc_script(path: Path | str) -> PlcScript:
    """The script of a file.

    Raises:
        InvalidInputError: what is wrong, with file and line.
    """
    section = read_yaml(path)
    declared = read_declarations(section)
    signals = declared.signals
    start = dict(_setting(below, key, signals) for below, key in section.entries('initial'))
    rules = tuple(_rule(item, signals) for item in section.sections('rules'))
    section.finish()
    if not (rules or start or declared.fail_safe or declared.emergency_stop):
        raise section.error('the file has no content; it needs rules, initial, fail_safe or emergency_stop')
    return PlcScript(rules, MappingProxyType(start), **vars(declared))


def _rule(item: YamlSection, signals: Mapping[str, Channel]) -> PlcRule:
    event, period = _trigger(item, signals)
    conditions = tuple(_condition(item, text, line, signals) for text, line in item.texts('if'))
    settings = tuple(_setting(below, key, signals) for below, key in item.entries('set'))
    if not settings:
        raise item.missing('set', 'the inputs to set and their values')
    return PlcRule(
        event=event,
        period=period,
        conditions=conditions,
        after=item.number('after', 0.0, low=0.0, high=LONGEST_TIME),
        settings=settings,
        duration=item.number('for', low=SHORTEST_PERIOD, high=LONGEST_TIME) if 'for' in item else math.inf,
        line=item.line,
    )


def _trigger(item: YamlSection, signals: Mapping[str, Channel]) -> tuple[Comparison | None, float]:
    text = item.text('when')
    if text == 'start':
        return None, math.inf
    if match := _EVERY.fullmatch(text):
        period = _number(item, match[1], item.line_of('when'))
        if not SHORTEST_PERIOD <= period <= LONGEST_TIME:
            raise item.error(
                f'every {period:g} s; valid is {SHORTEST_PERIOD:g} to {LONGEST_TIME:g} s', 'when'
            )
        return None, period
    match = _EVENT.fullmatch(text)
    if match is None:
        raise item.error(
            f"when is {text!r}; valid are 'output rises', 'output falls', 'output changes', "
            f"'analog_output.1 above 2.5', 'analog_output.1 below 2.5', 'start' and 'every 5 s'",
            'when',
        )
    return _comparison(item, match, item.line_of('when'), signals), math.inf


def _condition(item: YamlSection, text: str, line: int, signals: Mapping[str, Channel]) -> Comparison:
    match = _CONDITION.fullmatch(text)
    if match is None:
        raise located(
            item.file,
            line,
            f"if is {text!r}; valid are 'input is on', 'input is off', 'analog_output.1 above 2.5' and "
            f"'analog_output.1 below 2.5'",
        )
    return _comparison(item, match, line, signals)


def _comparison(
    item: YamlSection, match: re.Match[str], line: int, signals: Mapping[str, Channel]
) -> Comparison:
    name, word, relation, bound = match.groups()
    channel = channel_at(item, name, line, signals)
    if word == 'changes':
        return Comparison(channel, 'changes')
    if word and channel.kind == 'analog':
        change = '' if word in ('on', 'off') else ', or change'
        raise located(item.file, line, f'{name} is analog; it can be above or below a number{change}')
    if word:
        return Comparison(channel, 'is', float(word in ('rises', 'on')))
    if channel.kind == 'digital':
        raise located(item.file, line, f'{channel.name} is digital; it can rise, fall, change, be on or off')
    return Comparison(channel, 'above' if relation == 'above' else 'below', _number(item, bound, line))


def _setting(section: YamlSection, key: str, signals: Mapping[str, Channel]) -> tuple[Channel, float]:
    channel = channel_at(section, key, section.line_of(key), signals)
    if channel.direction == 'output':
        raise section.error(f'{key} is an output, which the robot program sets; a PLC sets inputs', key)
    return channel, value_at(section, key, channel)


def _number(section: YamlSection, text: str, line: int) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise located(section.file, line, f'{text!r} is no finite number')
    return number

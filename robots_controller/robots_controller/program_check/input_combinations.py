"""InputCombination: one state of all inputs that a PLC script names, at the start of a program."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import MappingProxyType

from robots_controller.io.io_image import Channel
from robots_controller.io.plc_script import PlcScript


@dataclass(frozen=True)
class InputCombination:
    """Values of the inputs at the start; from there the script's rules set them.

    Attributes:
        values: (input, value), all that the script names.
        names: Own names of channels.
    """

    values: tuple[tuple[Channel, float], ...] = ()
    names: tuple[tuple[Channel, str], ...] = ()

    def script(self, script: PlcScript) -> PlcScript:
        """The script with these values at its start."""
        return replace(script, initial=MappingProxyType(dict(self.values)))

    def describe(self) -> str:
        """For a person: press_ready on, press_force 0."""
        names = dict(self.names)
        words = (
            f'{names.get(channel, channel.name)} '
            f'{("off", "on")[int(value)] if channel.kind == "digital" else format(value, "g")}'
            for channel, value in self.values
        )
        return ', '.join(words)


def input_combinations(script: PlcScript) -> Iterator[InputCombination]:
    """Every combination of the inputs that a script sets, starts with or names; its own start comes first.

    A digital input is off or on; an analog one has any of the values that the script gives it, or 0.
    """
    inputs = tuple(channel for channel in script.channels if channel.direction == 'input')
    names = tuple((channel, name) for name, channel in script.signals.items())
    choices = [_values(script, channel) for channel in inputs]
    for values in itertools.product(*choices):
        yield InputCombination(tuple(zip(inputs, values, strict=True)), names)


def _values(script: PlcScript, channel: Channel) -> tuple[float, ...]:
    own = float(script.initial.get(channel, 0.0))
    given = {0.0, 1.0} if channel.kind == 'digital' else {0.0}
    given |= {value for rule in script.rules for one, value in rule.settings if one == channel}
    return (own, *sorted(given - {own}))

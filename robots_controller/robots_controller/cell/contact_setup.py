"""ContactSetup: a wheel on soil and the force control that presses it, read from a file."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Final

import numpy as np

from robots_controller.io.io_image import Channel
from robots_controller.io.io_signals import channel_at
from robots_core.blocks.force_control.force_control import ForceControlSettings
from robots_core.blocks.terramechanics.soil import SOILS, Soil
from robots_core.blocks.terramechanics.wheel_contact import SoilBed, WheelContact
from robots_core.blocks.terramechanics.wheel_soil_model import Wheel, WheelSoilModel
from robots_core.errors import InvalidInputError, OptionError
from robots_core.files.yaml_section import YamlSection, read_yaml
from robots_core.validation import Array, bounded_vector, finite_vector

VECTORS: Final = ('press', 'drive')
FARTHEST: Final = 1e6  # m, of places, and of what directions are given by


@dataclass(frozen=True, eq=False)
class ContactSetup:
    """A wheel, its soil and its force control.

    Attributes:
        wheel: The wheel.
        soil: The soil.
        bed: Where it is.
        hub: Of the wheel in tool0, (3,) m.
        forward: Where it rolls to, in tool0, (3,).
        control: How it is pressed.
        load: Analog output of the load, N.
        speed: Analog output of the speed along `control.drive`, m/s.
        slip: Analog output of the slip that the wheel's drive keeps.
    """

    wheel: Wheel
    soil: Soil
    bed: SoilBed
    hub: Array
    forward: Array
    control: ForceControlSettings
    load: Channel
    speed: Channel
    slip: Channel

    def contact(self) -> WheelContact:
        """The wheel on its soil."""
        return WheelContact(
            WheelSoilModel(self.wheel, self.soil), self.bed, hub=self.hub, forward=self.forward
        )


def read_contact(path: Path | str) -> ContactSetup:
    """The setup of a YAML file; `docs/reference/contact_and_orbit_files.md` describes it.

    Raises:
        InvalidInputError: a file that is missing or not such a setup; names the file and the line.
    """
    section = read_yaml(path)
    wheel, bed, control, outputs = map(section.needed_section, ('wheel', 'bed', 'force_control', 'outputs'))
    x, y, height = _vector(bed, 'x', 2), _vector(bed, 'y', 2), bed.number('height')
    radius, width = wheel.number('radius'), wheel.number('width')
    setup = ContactSetup(
        wheel=wheel.checked(lambda: Wheel(radius=radius, width=width)),
        soil=section.made('soil', _soil),
        bed=bed.checked(lambda: SoilBed(height, np.array([x[0], y[0]]), np.array([x[1], y[1]]))),
        hub=_vector(wheel, 'hub'),
        forward=_vector(wheel, 'forward'),
        control=_control(control),
        **{name: _output(outputs, name) for name in ('load', 'speed', 'slip')},
    )
    section.finish()
    wheel.checked(setup.contact)
    return setup


def check_one_guide(*guides: Path | str) -> None:
    """Check that a recording or a cabin, force control, or a camera guides the robot of a cell, not two.

    Raises:
        RobotsError: there are more.
    """
    given = [str(guide) for guide in guides if guide]
    if len(given) > 1:
        raise OptionError(
            f'{" and ".join(given)} both guide the robot: give a recording or a cabin, a contact or an '
            f'orbit, not two'
        )


def _vector(section: YamlSection, key: str, size: int = 3) -> Array:
    return section.made(key, lambda value: bounded_vector(value, size, key, FARTHEST, 'm'))


def _soil(value: Any) -> Soil:
    if isinstance(value, str) and value in SOILS:
        return SOILS[value]
    names = [field.name for field in fields(Soil)]
    if not isinstance(value, dict) or set(value) != set(names):
        raise InvalidInputError(f'soil is one of {", ".join(SOILS)}, or a mapping of {", ".join(names)}')
    numbers = finite_vector([value[name] for name in names], len(names), 'soil')
    return Soil(**dict(zip(names, numbers.tolist(), strict=True)))


def _control(section: YamlSection) -> ForceControlSettings:
    vectors: dict[str, Any] = {name: _vector(section, name) for name in VECTORS}
    names = [field.name for field in fields(ForceControlSettings) if field.name not in VECTORS]
    numbers: dict[str, Any] = {name: section.number(name) for name in names}
    return section.checked(lambda: ForceControlSettings(**vectors, **numbers))


def _output(section: YamlSection, key: str) -> Channel:
    channel = channel_at(section, section.text(key), section.line_of(key), {})
    if channel.image != 'analog_outputs':
        raise section.error(f'{key} is {channel.name}; valid is an analog output', key)
    return channel

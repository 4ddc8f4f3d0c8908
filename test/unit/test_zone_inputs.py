"""Inputs that close zones."""

from __future__ import annotations

import pytest

from robots_controller.io.io_image import Channel
from robots_controller.io.stopping_inputs import closed_zones, closing_inputs, closing_texts, parse_closing
from robots_core.blocks import Zone
from robots_core.errors import InvalidInputError

from .zone_cell import wall

ZONES = (wall(0.1), Zone('other', wall(0.2).region, 'out', 'tool', {'free': False, 'digital_input.3': True}))
SIGNALS = {'free': Channel('digital', 'input', 2, 'free')}


def test_inputs_close_zones_as_the_scene_says() -> None:
    closing = closing_inputs(ZONES, SIGNALS)
    assert closing == {'press': {1: 0}, 'other': {2: 0, 3: 1}}
    for inputs in (closing, parse_closing(closing_texts(closing))):
        assert closed_zones(inputs, [1, 1, 0]) == frozenset()
        assert closed_zones(inputs, [0, 1, 0]) == {'press'}
        assert closed_zones(inputs, [1, 0, 0]) == closed_zones(inputs, [1, 1, 1]) == {'other'}
        assert closed_zones(inputs, [1]) == {'other'}  # of what is not known there is nothing to open it
    assert not parse_closing([''])


@pytest.mark.parametrize(
    ('closed_by', 'reason'),
    [
        ({'press_open': False}, "zone 'x': closed_by: 'press_open' is no channel"),
        ({'digital_output.1': False}, 'digital_output.1 is no digital input'),
        ({'free': False, 'digital_input.2': True}, 'names digital_input.2 twice'),
    ],
)
def test_what_is_no_input_closes_no_zone(closed_by: dict[str, bool], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        closing_inputs([Zone('x', ZONES[0].region, 'out', 'tool', closed_by)], SIGNALS)


@pytest.mark.parametrize(
    'text', ['press', 'digital_input.1=off', 'digital_output.1=off press', 'digital_input.1=0 p']
)
def test_a_parameter_of_another_form_is_refused(text: str) -> None:
    with pytest.raises(InvalidInputError):
        parse_closing([text])

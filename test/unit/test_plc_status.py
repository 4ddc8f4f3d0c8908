"""What a scripted PLC will do, as text and back."""

from __future__ import annotations

import pytest

from robots_controller.io.scripted_plc import Pending, pending_as_text, pending_from_text
from robots_core.errors import InvalidInputError


def test_changes_come_back_on_the_clock_of_the_reader() -> None:
    changes: Pending = ((2.5, 7, {'digital_input.3': 1.0}), (4.0, 9, {}))
    text = pending_as_text(changes, 100.0)
    assert pending_from_text(text, 101.0) == ((1.5, 7, {'digital_input.3': 1.0}), (3.0, 9, {}))


@pytest.mark.parametrize(
    'text',
    [
        '',
        'soon',
        '3',
        '[3]',
        '[[1.0, 2]]',
        '[["1", 2, {}]]',
        '[[1.0, 2, []]]',
        '[[1.0, 2, {"a": "b"}]]',
        '[[NaN, 2, {}]]',
        '[[1.0, 2, {"a": 1e999}]]',
        f'[[{10**400}, 2, {{}}]]',
        5000 * '[',
    ],
)
def test_text_of_another_form_is_refused(text: str) -> None:
    with pytest.raises(InvalidInputError, match='is no list of'):
        pending_from_text(text, 0.0)

"""Numbers inside messages by path."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.io.bridge.topic_field import FieldPath
from robots_core.errors import InvalidInputError


def message() -> Any:
    return SimpleNamespace(
        data=[1, 2, 3], pose=SimpleNamespace(position=SimpleNamespace(x=0.5)), rows=[SimpleNamespace(v=[7])]
    )


@pytest.mark.parametrize(
    ('text', 'value'), [('data[2]', 3), ('pose.position.x', 0.5), ('rows[0].v[0]', 7), ('data', [1, 2, 3])]
)
def test_a_value_is_read(text: str, value: object):
    assert FieldPath.parse(text).get(message()) == value


@pytest.mark.parametrize('text', ['data[1]', 'pose.position.x', 'rows[0].v[0]'])
def test_what_is_set_is_read_again_and_nothing_else_changes(text: str):
    changed, path = message(), FieldPath.parse(text)
    path.set(changed, 9)
    assert path.get(changed) == 9
    path.set(changed, path.get(message()))
    assert changed == message()


def test_an_array_that_is_too_short_is_reported():
    with pytest.raises(InvalidInputError, match=r'data has 3 elements; data\[3\] needs 4'):
        FieldPath.parse('data[3]').get(message())


@pytest.mark.parametrize(
    'text', ['', '.', '.a', 'a.', 'a..b', '[0]', 'a[', 'a[]', 'a[-1]', 'a[0]b', 'a b', 'a[1e3]', '1a']
)
def test_what_is_no_path_is_reported(text: str):
    with pytest.raises(InvalidInputError, match='is no path of a field'):
        FieldPath.parse(text)


@given(
    st.from_regex(r'[a-z_]{1,5}', fullmatch=True),
    st.lists(st.one_of(st.from_regex(r'[a-z_]{1,5}', fullmatch=True), st.integers(0, 999)), max_size=5),
)
def test_a_path_is_its_steps_and_back(first: str, rest: list[str | int]):
    steps = (first, *rest)
    text = FieldPath('', steps).up_to(len(steps))
    path = FieldPath.parse(text)
    assert path.steps == steps
    assert path.up_to(len(steps)) == path.text == text

"""Modal settings as text, for messages and bags."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import pytest

from robots_core.errors import InvalidInputError
from robots_planning import MotionSettings
from robots_planning.motion_settings import DESCRIPTIONS, settings_from_text, settings_status


def test_text_and_back_is_exact() -> None:
    settings = MotionSettings(
        speed_fraction=1.0 / 3.0,
        jerk_limited=True,
        configuration='front/up/no_flip',
        tool=(0.0, 0.1, 0.2 + 1e-16, 0.0, 0.0, 0.0, 1.0),
        blend_zone=0.1,
    )
    texts = settings_status(settings).values
    assert settings_from_text(texts) == settings
    assert list(texts) == list(DESCRIPTIONS)


def test_motions_of_the_pendant_have_settings_of_their_own_beside_those_of_programs() -> None:
    settings = MotionSettings(cartesian_speed=1.0, speed_fraction=0.9, blend_zone=0.1)
    own = {'speed_fraction': 0.05, 'cartesian_speed': 0.02}
    texts = settings_status(settings, own).values
    assert settings_from_text(texts) == settings
    assert settings_from_text(texts, pendant=True) == replace(settings, **own, blend_zone=0.0)
    assert settings_from_text(settings_status(settings).values, pendant=True) == replace(
        settings, blend_zone=0.0
    )


def test_what_is_missing_has_its_default() -> None:
    assert settings_from_text({}) == MotionSettings()
    assert settings_from_text({'cartesian_speed': '0.25'}) == MotionSettings(cartesian_speed=0.25)


def test_every_setting_is_reported() -> None:
    assert {name: json.loads(text) for name, text in settings_status(MotionSettings()).values.items()} == {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in asdict(MotionSettings()).items()
    }


@pytest.mark.parametrize(
    ('texts', 'message'),
    [
        ({'colour': '1'}, "unknown setting 'colour'; settings are speed_fraction"),
        ({'pendant.tool': '[0, 0, 0, 0]'}, "unknown setting 'pendant.tool'"),
        ({'tool': 'left'}, "tool = 'left' is not JSON"),
        ({'tool': '[1, 2]'}, 'tool must have'),
        ({'speed_fraction': '2.0'}, 'speed_fraction'),
        ({'cartesian_speed': 'NaN'}, 'cartesian_speed'),
        ({'payload': '1.0'}, r'payload = 1.0 is not of the type of \[0.0, 0.0, 0.0, 0.0\]'),
        ({'tool': '[1, "x"]'}, 'tool = .* is not of the type of'),
        ({'avoid': '1'}, 'avoid = 1 is not of the type of false'),
        ({'most_replans': '2.5'}, 'most_replans = 2.5 is not of the type of 5'),
        ({'tool': 5000 * '['}, "tool = '\\[+' is not JSON"),
        ({'base': f'[{10**400}]'}, 'base = .* too large'),
    ],
)
def test_what_is_no_setting_is_refused(texts: dict[str, str], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        settings_from_text(texts)

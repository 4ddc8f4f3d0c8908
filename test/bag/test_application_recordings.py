"""The paper's applications, run again as they were recorded: the same motion, forces and events."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.testing import assert_bag_matches

from .application_runs import COMMON, RECORDED, TOPICS, keep, run

# Another machine rounds differently; text of a grasp has four digits.
TOLERANCES = """
default: {time: 1.0e-6, absolute: 1.0e-6, relative: 1.0e-6}
topics:
  joint_states: {fields: {'effort[*]': 1.0e-2}}
  measured_wrench: {absolute: 1.0e-3}
"""


@pytest.mark.parametrize('name', TOPICS)
def test_an_application_does_what_was_recorded(name: str, tmp_path: Path) -> None:
    result = run(name, tmp_path)
    assert result.ok, result.error
    keep(name, tmp_path / 'bag', tmp_path / 'kept')
    (tmp_path / 'tolerances.yaml').write_text(TOLERANCES)
    comparison = assert_bag_matches(tmp_path / 'kept', RECORDED / name, tmp_path / 'tolerances.yaml')
    compared = {found.topic.removeprefix('/') for found in comparison.topics}
    assert compared == {*COMMON, *TOPICS[name]}

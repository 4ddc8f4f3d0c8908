"""What a person cannot record or report on is refused with the reason."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.pendant.recording import Recording
from robots_core.errors import BagError


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / 'out').write_text('a file')
    recording = Recording(tmp_path / 'out', 'bello_bot')
    with pytest.raises(BagError, match=r'no bag can be written to .*out/recorded_'):
        recording.begin()
    assert recording.bag == ''
    recording.end()


def test_without_a_bag_there_is_no_report(tmp_path: Path) -> None:
    with pytest.raises(BagError, match=r'there is no bag in .*; record one'):
        Recording(tmp_path, 'bello_bot').report()

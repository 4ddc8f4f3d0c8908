"""What a machine remembers of its cells."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from robots_controller.runtime_folder import alone, first_time
from robots_core.errors import RobotsError


@pytest.fixture(autouse=True)
def _own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv('XDG_RUNTIME_DIR', str(tmp_path))


def test_a_first_time_is_the_only_one_of_its_name():
    assert [first_time('a/../b'), first_time('a/../b'), first_time('c')] == [True, False, True]


def test_one_process_is_alone_until_it_ends():
    with alone('cell 0 /'):
        with pytest.raises(RobotsError, match=f'it is process {os.getpid()}'), alone('cell 0 /'):
            pytest.fail('two are alone')
        with alone('cell 0 /a/b'), alone('cell 0 /a_b'), alone('cell 1 /'):
            pass
    with alone('cell 0 /'):
        pass


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path):
    (tmp_path / 'robots').write_text('')
    with pytest.raises(RobotsError, match='robots cannot be made'):
        first_time('a')

"""The browser of this machine."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from playwright.sync_api import Browser, sync_playwright

CHROMES: Final = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')
DEADLINE: Final = 240.0  # s, for a machine that is slow and busy


def installed_browser() -> str:
    """The path of a Chromium; '' for none."""
    return next((path for name in CHROMES if (path := shutil.which(name))), '')


@contextmanager
def browser(*arguments: str) -> Iterator[Browser]:
    """The browser, without a window."""
    path = installed_browser()
    assert path, 'there is no Chromium: make browser'
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(
            executable_path=path, args=['--no-sandbox', *arguments], timeout=1e3 * DEADLINE
        )
        try:
            yield started
        finally:
            started.close()

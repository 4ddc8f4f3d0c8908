"""The browser that the tests of a module share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from installed_browsers import browser

from .browser_page import empty_page


@pytest.fixture(scope='module')
def running() -> Iterator[Browser]:
    with browser('--disable-gpu') as started:
        yield started


@pytest.fixture(scope='module')
def window(running: Browser) -> Iterator[Page]:
    """For one page after the other: see `shown`."""
    page = empty_page(running, viewport={'width': 1024, 'height': 768})
    yield page
    page.context.close()

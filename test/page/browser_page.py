"""A page in the browser of this machine, whose conditions are waited for."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import Browser, Page

from installed_browsers import DEADLINE

POLL = 20.0  # ms
LONGEST_POLL = 100.0  # ms
SOCKET = '_nicegui_ws/socket.io/?EIO=4&transport=websocket'
FORWARDS = '[data-press="axes 0 +"]'


def open_page(running: Browser, url: str, **options: Any) -> Page:
    """A page in a context of its own, once it can be used."""
    page = empty_page(running, **options)
    go_to(page, url)
    return page


def empty_page(running: Browser, **options: Any) -> Page:
    """A page in a context of its own, without an address."""
    page = running.new_context(**{'locale': 'en-US', **options}).new_page()
    page.set_default_timeout(1e3 * DEADLINE)
    return page


def go_to(page: Page, url: str) -> None:
    """Let a page be another one, until that can be used."""
    page.goto(url)
    page.wait_for_function('() => window.socket?.connected && window.did_handshake')


@contextmanager
def shown(window: Page, url: str) -> Iterator[Page]:
    """A page in a window that there is already: a quarter of the processor time of one in another context."""
    go_to(window, url)
    try:
        yield window
    finally:
        window.mouse.up()
        window.goto('about:blank')


def wait(page: Page, condition: Callable[[], Any], what: str) -> None:
    """Wait until a condition is true; the browser goes on meanwhile."""
    deadline = time.monotonic() + DEADLINE
    pause = POLL
    while not condition():
        assert time.monotonic() < deadline, what
        page.wait_for_timeout(pause)
        pause = min(1.5 * pause, LONGEST_POLL)


def take_control(page: Page) -> None:
    """Let the page be in control."""
    if page.locator('.control.own').count() == 0:
        page.get_by_role('button', name='Take control').click()
        page.locator('.control.own').wait_for()


def press(page: Page, selector: str) -> None:
    """Press the mouse on an element, without releasing it."""
    page.locator(selector).hover()
    page.mouse.down()

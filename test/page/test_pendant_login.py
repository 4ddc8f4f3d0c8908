"""The operator's page behind a password, in a real browser."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from installed_browsers import DEADLINE, browser
from robots_controller.pendant.page_access import PageAccess

from .browser_page import SOCKET, wait
from .made_up_cell import made_up_operator, served

PASSWORD = 'open sesame'  # noqa: S105


def test_viewers_log_in_with_the_password() -> None:
    operator, cell = made_up_operator()
    with served(operator, access=PageAccess(password=PASSWORD)) as url, browser('--disable-gpu') as running:
        with pytest.raises(InvalidStatus, match='403'):
            connect(f'{url.replace("http", "ws")}/{SOCKET}', origin=url, open_timeout=DEADLINE)
        page = running.new_context(locale='de-DE').new_page()
        page.set_default_timeout(1e3 * DEADLINE)
        page.goto(url)
        page.get_by_label('Passwort').fill('guess')
        page.get_by_role('button', name='Anmelden').click()
        page.get_by_text('Falsches Passwort').wait_for()
        wait(page, lambda: logged_in(page), 'the end of the delay')
        page.wait_for_function('() => window.socket?.connected && window.did_handshake')
        page.get_by_text('Niemand bedient').wait_for()
        page.locator('.stop').click()
        wait(page, lambda: cell.calls == [('stop',)], 'a stop')


def logged_in(page: Page) -> bool:
    page.get_by_label('Passwort').fill(PASSWORD)
    with page.expect_navigation():
        page.get_by_role('button', name='Anmelden').click()
    return page.get_by_label('Passwort').count() == 0

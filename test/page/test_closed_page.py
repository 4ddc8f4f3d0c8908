"""A page that is closed, or has lost its connection, has no control any more."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from nicegui import Client, core
from playwright.sync_api import Browser, Page

from robots_controller.pendant.page.access.page_server import CONNECTION_TIMEOUT, RECONNECT_TIMEOUT
from robots_controller.pendant.page.pendant_page import GONE_AFTER
from robots_controller.pendant.pendant_operator import PendantOperator

from .browser_page import FORWARDS, POLL, open_page, press, shown, take_control, wait
from .made_up_cell import made_up_operator, served
from .silent_network import silent_network


@pytest.fixture
def served_cell() -> Iterator[tuple[PendantOperator, str]]:
    operator, _ = made_up_operator()
    with served(operator) as url:
        yield operator, url


def test_a_page_that_is_closed_gives_control_back_long_before_it_is_forgotten(
    running: Browser, window: Page, served_cell: tuple[PendantOperator, str]
) -> None:
    operator, url = served_cell
    with shown(window, url) as looking:
        closed = open_page(running, url)
        take_control(closed)
        holder = operator.desk.holder
        closed.close()
        wait(looking, lambda: not operator.desk.holder, 'control to be free')
        assert holder in Client.instances  # a connection may still come back
        assert GONE_AFTER <= 2.0 < RECONNECT_TIMEOUT
        looking.get_by_text('Nobody operates').wait_for()
        take_control(looking)


def test_a_page_without_connection_has_no_control_when_it_comes_back(
    window: Page, served_cell: tuple[PendantOperator, str]
) -> None:
    operator, url = served_cell
    with shown(window, url) as page:
        take_control(page)
        page.evaluate('() => window.socket.disconnect()')
        wait(page, lambda: not operator.desk.holder, 'control to be free')
        page.evaluate('() => window.socket.connect()')
        page.get_by_text('Nobody operates').wait_for()
        take_control(page)
        assert operator.desk.holder


def test_a_network_that_falls_silent_frees_control_within_seconds(window: Page) -> None:
    operator, cell = made_up_operator()
    with (
        served(operator, connection_timeout=CONNECTION_TIMEOUT) as url,
        silent_network(url) as network,
        shown(window, network.url) as page,
    ):
        silence = core.sio.eio.ping_interval + core.sio.eio.ping_timeout
        assert silence + GONE_AFTER <= 6.0
        while not cell.moving():  # a busy machine may hold the browser up
            take_control(page)
            press(page, FORWARDS)
            page.wait_for_timeout(POLL)
        network.silence()
        wait(page, lambda: not operator.desk.holder, 'control to be free')
        assert not cell.moving()
        jogs = len(cell.calls)
        page.get_by_text('Connection lost').wait_for()
        network.restore()
        page.get_by_text('Nobody operates').wait_for()
        assert len(cell.calls) == jogs  # signs of the press that come late move nothing

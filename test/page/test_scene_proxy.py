"""The 3D view through the page's own server: for viewers of the page alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from http import HTTPStatus
from socket import gethostname

import httpx
import numpy as np
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from installed_browsers import DEADLINE, browser
from robots_controller.pendant.page_access import PageAccess
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_core.blocks.visualizer import Visualizer

from .browser_page import wait
from .made_up_cell import made_up_operator, ready_state, served

PASSWORD = 'open sesame'  # noqa: S105
VERSION = Subprotocol('viser-v1.1.1')


@pytest.fixture(scope='module')
def operator() -> PendantOperator:
    return made_up_operator()[0]


@pytest.fixture(scope='module')
def scene(operator: PendantOperator) -> Iterator[Visualizer]:
    visualizer = Visualizer(operator.robot, port=0)
    visualizer.update(np.array(operator.robot.home))
    yield visualizer
    visualizer.close()


@pytest.fixture(scope='module')
def url(operator: PendantOperator, scene: Visualizer) -> Iterator[str]:
    operator.state = replace(ready_state(operator.robot), scene_url=scene.url)
    with served(operator, access=PageAccess('0.0.0.0', PASSWORD)) as address:  # noqa: S104
        yield f'http://127.0.0.1:{address.rpartition(":")[2]}'


@pytest.fixture(scope='module')
def session(url: str) -> str:
    """The cookie of a viewer who has given the password."""
    answer = httpx.post(f'{url}/login', data={'password': PASSWORD}, timeout=DEADLINE, trust_env=False)
    assert answer.status_code == HTTPStatus.SEE_OTHER
    return answer.headers['set-cookie'].partition(';')[0]


def get(url: str, **headers: str) -> httpx.Response:
    return httpx.get(url, headers=headers, timeout=DEADLINE, trust_env=False)


@contextmanager
def connected(url: str, origin: str, **headers: str) -> Iterator[bytes]:
    """The first message of the scene."""
    address = f'{url.replace("http", "ws")}/scene'
    with connect(
        address, origin=origin, additional_headers=headers, subprotocols=[VERSION], open_timeout=DEADLINE
    ) as socket:
        assert socket.subprotocol == VERSION
        first = socket.recv(DEADLINE)
        assert isinstance(first, bytes)
        yield first


def test_without_a_session_the_scene_is_refused(url: str) -> None:
    answer = get(f'{url}/scene/')
    assert answer.status_code == HTTPStatus.UNAUTHORIZED
    assert 'viser' not in answer.text.lower()
    with pytest.raises(InvalidStatus, match='403'), connected(url, url):
        pass
    with pytest.raises(InvalidStatus, match='403'), connected(url, url, cookie='pendant_session=forged'):
        pass


def test_with_a_session_the_scene_is_what_its_own_server_says(
    url: str, session: str, scene: Visualizer
) -> None:
    answer = get(f'{url}/scene/', cookie=session)
    assert answer.status_code == HTTPStatus.OK
    assert answer.text == get(scene.url).text
    assert '<title>Viser</title>' in answer.text
    assert answer.headers['x-frame-options'] == 'SAMEORIGIN'
    assert get(url, cookie=session).headers['x-frame-options'] == 'DENY'
    with connected(url, url, cookie=session) as first:
        assert first
    assert get(f'{url}/scene/nothing', cookie=session).status_code == HTTPStatus.NOT_FOUND
    post = httpx.post(f'{url}/scene/', headers={'cookie': session}, timeout=DEADLINE, trust_env=False)
    assert post.status_code == HTTPStatus.METHOD_NOT_ALLOWED


def test_a_foreign_origin_is_refused_with_a_session_too(url: str, session: str) -> None:
    foreign = 'http://example.org'
    assert get(f'{url}/scene/', cookie=session, origin=foreign).status_code == HTTPStatus.FORBIDDEN
    with pytest.raises(InvalidStatus, match='403'), connected(url, foreign, cookie=session):
        pass


@pytest.mark.parametrize('other', ['', 'http://192.0.2.1:80', 'https://127.0.0.1:1', 'http://127.0.0.1:1'])
def test_only_a_scene_of_this_machine_is_asked(
    url: str, session: str, operator: PendantOperator, other: str
) -> None:
    before = operator.state
    operator.state = replace(before, scene_url=other)
    try:
        assert get(f'{url}/scene/', cookie=session).status_code == HTTPStatus.BAD_GATEWAY
        with pytest.raises(InvalidStatus, match='403'), connected(url, url, cookie=session):
            pass
    finally:
        operator.state = before


def test_a_browser_on_another_machine_shows_the_scene(url: str, scene: Visualizer) -> None:
    """Another name of this machine stands for another machine."""
    name = gethostname().lower()
    elsewhere = url.replace('127.0.0.1', name)
    with browser('--disable-gpu', f'--host-resolver-rules=MAP {name} 127.0.0.1') as running:
        page = running.new_context(locale='en-US').new_page()
        page.set_default_timeout(1e3 * DEADLINE)
        wait(page, lambda: not scene.watched, 'the end of those before')
        page.goto(elsewhere)
        page.get_by_label('Password').fill(PASSWORD)
        page.get_by_role('button', name='Log in').click()
        page.locator('.scene iframe[src="/scene/"]').wait_for()
        wait(page, lambda: scene.watched, 'the scene in the page')

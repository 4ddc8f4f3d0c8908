"""What opens a report: the headless Chromium that comes with kaleido, and the browsers of this machine."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import re
import subprocess
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

from installed_browsers import installed_browser

KALEIDO = 'kaleido'
BROWSERS = [KALEIDO, *filter(None, [installed_browser()])]
DEADLINE = 60.0  # s
# Colours of every canvas of the page: of plots those that are neither white nor transparent, of the view all.
LOOK = """(() => [...document.querySelectorAll('canvas')].map((canvas) => {
  const flat = document.createElement('canvas');
  flat.width = canvas.width; flat.height = canvas.height;
  const pen = flat.getContext('2d');
  pen.drawImage(canvas, 0, 0);
  const pixels = new Uint32Array(pen.getImageData(0, 0, flat.width, flat.height).data.buffer);
  return [canvas.getAttribute('aria-label'), new Set(pixels).size];
}))()"""


# What kaleido calls for each line that comes in; its own draws plots. Handlers are there before the page is.
SCOPE = """var kaleido_scopes = {plotly: ({data}) => new Promise((resolve) => {
  const errors = [], frame = document.createElement('iframe');
  frame.style.cssText = 'width: 1400px; height: 1000px';
  document.body.appendChild(frame);
  const view = frame.contentWindow;
  frame.contentDocument.open();
  view.addEventListener('error', (event) => errors.push(String(event.message || event.target)), true);
  view.addEventListener('unhandledrejection', (event) => errors.push(String(event.reason)));
  view.console.error = (...words) => errors.push(words.join(' '));
  view.addEventListener('load', () => view.requestAnimationFrame(() => view.requestAnimationFrame(() => {
    const loaded = view.performance.getEntriesByType('resource').map((entry) => entry.name);
    const result = JSON.stringify({errors: [...errors, ...loaded], colours: view.eval(data.look)});
    resolve({code: 0, message: '', result, format: 'json'});
  })));
  frame.contentDocument.write(data.page);
  frame.contentDocument.close();
})};"""


@dataclass(frozen=True)
class Opened:
    """What a browser made of a page.

    Attributes:
        errors: Of its scripts, and of anything that it wanted to load.
        colours: (label, number of colours) of each canvas.
    """

    errors: list[str]
    colours: list[tuple[str, int]]


def open_page(browser: str, path: Path, folder: Path) -> Opened:
    """Open a page in a headless browser.

    Args:
        browser: One of `BROWSERS`.
        path: The page.
        folder: The browser's own.
    """
    return _open_in_kaleido(path, folder) if browser == KALEIDO else _open_in_chrome(browser, path, folder)


def _open_in_kaleido(path: Path, folder: Path) -> Opened:
    """Open a page in the headless Chromium of kaleido, which needs no library of the system."""
    spec = importlib.util.find_spec('kaleido')
    assert spec is not None
    assert spec.submodule_search_locations
    home = Path(spec.submodule_search_locations[0]) / 'executable'
    for name, script in (('kaleido_scopes.js', SCOPE), ('nothing.js', '')):
        (folder / 'js').mkdir(parents=True, exist_ok=True)
        (folder / 'js' / name).write_text(script, encoding='utf-8')
    nothing = (folder / 'js' / 'nothing.js').as_uri()
    places = {'LD_LIBRARY_PATH': 'lib', 'FONTCONFIG_PATH': 'etc/fonts', 'XDG_DATA_HOME': 'xdg'}
    page = json.dumps({'data': {'page': path.read_text(encoding='utf-8'), 'look': LOOK}, 'format': 'json'})
    done = subprocess.run(
        [home / 'bin' / 'kaleido', 'plotly', '--no-sandbox', f'--plotlyjs={nothing}', f'--mathjax={nothing}'],
        input=f'{page}\n',
        cwd=folder,
        env={**os.environ, **{name: str(home / place) for name, place in places.items()}},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=True,
    )
    started, opened = (json.loads(line) for line in done.stdout.splitlines()[:2])
    assert started['code'] == opened['code'] == 0, done.stdout
    told = json.loads(opened['result'])
    return Opened(told['errors'], [(label, count) for label, count in told['colours']])


def _open_in_chrome(browser: str, path: Path, profile: Path) -> Opened:
    """Open a page in a headless browser over the Chrome DevTools protocol."""
    options = ['--headless=new', '--no-sandbox', '--no-first-run', '--disable-background-networking']
    options += ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader']
    options += [f'--user-data-dir={profile}', '--remote-debugging-port=0', '--window-size=1400,1000']
    with _running([browser, *options, 'about:blank']) as port:
        with urllib.request.urlopen(f'http://127.0.0.1:{port}/json', timeout=DEADLINE) as answer:
            tabs = json.load(answer)
        address = next(tab['webSocketDebuggerUrl'] for tab in tabs if tab['type'] == 'page')
        with connect(address, max_size=None, open_timeout=DEADLINE) as socket:
            return _look(_Tab(socket), path)


def _look(tab: _Tab, path: Path) -> Opened:
    for domain in ('Page', 'Runtime', 'Log', 'Network'):
        tab.call(f'{domain}.enable')
    tab.call('Page.navigate', url=path.as_uri())
    tab.until('Page.loadEventFired')
    # The view and the plots are drawn while the page loads; a frame later they are on the canvases.
    tab.evaluate('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))')
    colours = [(label, count) for label, count in tab.evaluate(LOOK)]
    errors = [
        json.dumps(event['params'])
        for event in tab.events
        if event['method'] == 'Runtime.exceptionThrown'
        or (event['method'] == 'Log.entryAdded' and event['params']['entry']['level'] == 'error')
        or (
            event['method'] == 'Network.requestWillBeSent'
            and event['params']['request']['url'] != path.as_uri()
        )
    ]
    return Opened(errors, colours)


class _Tab:
    """A page of the browser."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._number = 0
        self.events: list[dict[str, Any]] = []

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._number += 1
        self._socket.send(json.dumps({'id': self._number, 'method': method, 'params': parameters}))
        while True:
            message = self._receive()
            if message.get('id') == self._number:
                assert 'error' not in message, message
                return dict(message['result'])

    def until(self, method: str) -> None:
        while not any(event['method'] == method for event in self.events):
            self._receive()

    def evaluate(self, expression: str) -> Any:
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True)
        assert 'exceptionDetails' not in result, result
        return result['result'].get('value')

    def _receive(self) -> dict[str, Any]:
        message: dict[str, Any] = json.loads(self._socket.recv(timeout=DEADLINE))
        if 'method' in message:
            self.events.append(message)
        return message


@contextlib.contextmanager
def _running(command: list[str]) -> Iterator[int]:
    """The browser, and the port where it listens; ended afterwards."""
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    try:
        for line in process.stderr:
            if found := re.search(r'DevTools listening on ws://[^:/]+:(\d+)/', line):
                break
        else:
            raise AssertionError(f'{command[0]} ended before it listened')
        yield int(found[1])
    finally:
        process.terminate()
        process.communicate(timeout=DEADLINE)

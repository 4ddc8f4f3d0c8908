"""What opens a report: the headless Chromium that comes with kaleido, and the browsers of this machine."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser

from installed_browsers import DEADLINE, browser, installed_browser

KALEIDO = 'kaleido'
BROWSERS = [KALEIDO, *filter(None, [installed_browser()])]
# Plots by the processor itself: as what a graphics card would draw, all takes it twice as long.
SOFTWARE_RENDERING = ('--disable-gpu', '--enable-unsafe-swiftshader')
# What is drawn while a page loads is on its canvases then; a frame may never come where nobody looks.
SETTLED = 'new Promise((done) => setTimeout(done))'
# Colours of every canvas of the page: of plots those that are neither white nor transparent, of the view all.
LOOK = """(() => [...document.querySelectorAll('canvas')].map((canvas) => {
  const flat = document.createElement('canvas');
  flat.width = canvas.width; flat.height = canvas.height;
  const pen = flat.getContext('2d');
  pen.drawImage(canvas, 0, 0);
  const pixels = new Uint32Array(pen.getImageData(0, 0, flat.width, flat.height).data.buffer);
  return [canvas.getAttribute('aria-label'), new Set(pixels).size];
}))()"""


# What kaleido calls for the line that comes in; its own draws plots. Handlers are there before the page is.
SCOPE = """const opened = (page, look) => new Promise((resolve) => {
  const errors = [], frame = document.createElement('iframe');
  frame.style.cssText = 'width: 1400px; height: 1000px';
  document.body.appendChild(frame);
  const view = frame.contentWindow;
  frame.contentDocument.open();
  view.addEventListener('error', (event) => errors.push(String(event.message || event.target)), true);
  view.addEventListener('unhandledrejection', (event) => errors.push(String(event.reason)));
  view.console.error = (...words) => errors.push(words.join(' '));
  view.addEventListener('load', () => setTimeout(() => {
    const loaded = view.performance.getEntriesByType('resource').map((entry) => entry.name);
    resolve({errors: [...errors, ...loaded], colours: view.eval(look)});
    frame.remove();
  }));
  frame.contentDocument.write(page);
  frame.contentDocument.close();
});
var kaleido_scopes = {plotly: async ({data}) => {
  const told = [];
  for (const page of data.pages) told.push(await opened(page, data.look));
  return {code: 0, message: '', result: JSON.stringify(told), format: 'json'};
}};"""


@dataclass(frozen=True)
class Opened:
    """What a browser made of a page.

    Attributes:
        errors: Of its scripts, and of anything that it wanted to load.
        colours: (label, number of colours) of each canvas.
    """

    errors: list[str]
    colours: list[tuple[str, int]]


def open_pages(name: str, paths: Sequence[Path], folder: Path) -> list[Opened]:
    """Open pages in a headless browser: a Chromium takes longer to start than to open them all.

    Args:
        name: One of `BROWSERS`.
        paths: The pages.
        folder: That of kaleido.
    """
    return _open_in_kaleido(paths, folder) if name == KALEIDO else _open_in_chrome(paths)


def _open_in_kaleido(paths: Sequence[Path], folder: Path) -> list[Opened]:
    """Open pages in the headless Chromium of kaleido, which needs no library of the system."""
    spec = importlib.util.find_spec('kaleido')
    assert spec is not None
    assert spec.submodule_search_locations
    home = Path(spec.submodule_search_locations[0]) / 'executable'
    for name, script in (('kaleido_scopes.js', SCOPE), ('nothing.js', '')):
        (folder / 'js').mkdir(parents=True, exist_ok=True)
        (folder / 'js' / name).write_text(script, encoding='utf-8')
    nothing = (folder / 'js' / 'nothing.js').as_uri()
    places = {'LD_LIBRARY_PATH': 'lib', 'FONTCONFIG_PATH': 'etc/fonts', 'XDG_DATA_HOME': 'xdg'}
    pages = [path.read_text(encoding='utf-8') for path in paths]
    line = json.dumps({'data': {'pages': pages, 'look': LOOK}, 'format': 'json'})
    done = subprocess.run(
        [home / 'bin' / 'kaleido', 'plotly', '--no-sandbox', f'--plotlyjs={nothing}', f'--mathjax={nothing}'],
        input=f'{line}\n',
        cwd=folder,
        env={**os.environ, **{name: str(home / place) for name, place in places.items()}},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=True,
    )
    started, answer = (json.loads(line) for line in done.stdout.splitlines()[:2])
    assert started['code'] == answer['code'] == 0, done.stdout
    return [
        Opened(told['errors'], [(label, count) for label, count in told['colours']])
        for told in json.loads(answer['result'])
    ]


def _open_in_chrome(paths: Sequence[Path]) -> list[Opened]:
    """Open pages in the browser of this machine."""
    with browser(*SOFTWARE_RENDERING) as running:
        return [_opened(running, path) for path in paths]


def _opened(running: Browser, path: Path) -> Opened:
    errors: list[str] = []
    with running.new_context() as context:
        page = context.new_page()
        page.set_default_timeout(1e3 * DEADLINE)
        page.on('pageerror', lambda error: errors.append(str(error)))
        page.on('console', lambda said: errors.append(said.text) if said.type == 'error' else None)
        page.on('request', lambda sent: errors.append(sent.url) if sent.url != path.as_uri() else None)
        page.goto(path.as_uri())
        page.evaluate(SETTLED)
        colours = [(label, count) for label, count in page.evaluate(LOOK)]
    return Opened(errors, colours)

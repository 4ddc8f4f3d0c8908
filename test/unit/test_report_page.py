"""The page's own script, run in V8 with a stub of the browser, and in headless browsers."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from py_mini_racer import MiniRacer

from robots_controller.report.comparison import compare_runs
from robots_controller.report.page.comparison_page import comparison_page
from robots_controller.report.page.page import report_page, write_page
from robots_controller.report.run_report import run_report
from robots_core.errors import RobotsError

from .report_bags import tending_bag
from .report_browsers import BROWSERS, Opened, open_pages

STUB = Path(__file__).with_name('dom_stub.js')
BREAKING = {'thrown': 'throw new Error("it broke")', 'rejected': 'Promise.reject("it broke")'}
HOSTILE = '-- </script><img src=x onerror=alert(1)>'


class _Parts(HTMLParser):
    """Text of the scripts, by their type, and what the page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.scripts: dict[str, str] = {}
        self.references: list[str] = []
        self.tags: list[str] = []
        self._type: str | None = None

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.references += [value or '' for name, value in attrs if name in ('src', 'href', 'srcset')]
        if tag == 'script':
            self._type = dict(attrs).get('type') or 'script'

    def handle_endtag(self, tag: str) -> None:
        if tag == 'script':
            self._type = None

    def handle_data(self, data: str) -> None:
        if self._type is not None:
            self.scripts[self._type] = self.scripts.get(self._type, '') + data


class Page:
    """A page whose script has run."""

    def __init__(self, text: str) -> None:
        self.parts = _Parts()
        self.parts.feed(text)
        self.data = json.loads(self.parts.scripts['application/json'])
        self._engine = MiniRacer()
        self._engine.eval(STUB.read_text(encoding='utf-8'))
        text = json.dumps(self.parts.scripts['application/json'])
        self._engine.eval(f"document.getElementById('data').textContent = {text}")
        self._engine.eval(self.parts.scripts['script'])

    def ask(self, expression: str) -> Any:
        """Value of an expression in the page."""
        return json.loads(str(self._engine.eval(f'JSON.stringify(({expression}) ?? null)')))


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp('page')
    return tending_bag(folder / 'a', hostile=HOSTILE), tending_bag(folder / 'b', slower=1.2, hostile=HOSTILE)


@pytest.fixture(scope='module')
def texts(bags: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    path = tmp_path_factory.mktemp('written') / 'new' / 'report.html'
    write_page(path, report_page(run_report(bags[0])))
    comparison = compare_runs(*(run_report(bag) for bag in bags))
    return {'report': path.read_text(encoding='utf-8'), 'comparison': comparison_page(comparison)}


@pytest.fixture(scope='module', params=['report', 'comparison'])
def page(request: pytest.FixtureRequest, texts: dict[str, str]) -> Page:
    return Page(texts[request.param])


def test_the_page_needs_nothing_else(page: Page):
    assert page.parts.references == []
    assert not re.search(r'https?:|import\s*\(|fetch\(|XMLHttpRequest', page.parts.scripts['script'])


def test_text_of_a_program_stays_text(page: Page):
    assert 'img' not in page.parts.tags
    shown = page.ask("document.getElementById('report').textContent")
    assert HOSTILE in shown


def test_every_panel_is_drawn(page: Page):
    titles = [panel['title'] for panel in page.data['panels']]
    assert len(titles) >= 6
    drawn = page.ask(
        "drawn.filter((d) => d.kind === '2d').map((d) => [d.canvas.attributes['aria-label'], d.calls])"
    )
    assert [title for title, _ in drawn] == titles
    for panel, (title, calls) in zip(page.data['panels'], drawn, strict=True):
        assert calls['clearRect'] >= 1, title
        if panel['kind'] == 'spans':
            assert calls['fillRect'] >= len(panel['lanes'][0]['spans']), title
        else:
            # More than ticks and frame: every curve with many points, every row with its edges.
            assert calls['lineTo'] >= 2 * len(panel['series']), title


def test_the_robot_is_drawn(page: Page):
    (calls,) = page.ask("drawn.filter((d) => d.kind === 'webgl').map((d) => d.calls)")
    parts = sum(len(robot['parts']) for robot in page.data['world']['robots'])
    assert calls['drawElements'] == parts
    assert calls['drawArrays'] == 1 + len(page.data['world']['robots'])


@pytest.fixture(scope='module', params=BROWSERS)
def opened(
    request: pytest.FixtureRequest, texts: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Opened]:
    """The pages, and two that break, as a browser has opened them."""
    folder = tmp_path_factory.mktemp('opened')
    broken = {
        name: f'<canvas aria-label="empty"></canvas><script>{script}</script>'
        for name, script in BREAKING.items()
    }
    paths = []
    for name, text in (texts | broken).items():
        paths.append(folder / f'{name}.html')
        paths[-1].write_text(text, encoding='utf-8')
    return dict(zip([*texts, *broken], open_pages(request.param, paths, folder / 'browser'), strict=True))


@pytest.mark.parametrize('script', BREAKING)
def test_browsers_report_what_goes_wrong(script: str, opened: dict[str, Opened]):
    assert 'it broke' in opened[script].errors[0]
    assert opened[script].colours == [('empty', 1)]


@pytest.mark.parametrize('kind', ['report', 'comparison'])
def test_it_opens_without_an_error(kind: str, texts: dict[str, str], opened: dict[str, Opened]):
    assert opened[kind].errors == []
    plots = {panel['title'] for panel in Page(texts[kind]).data['panels']}
    assert {label for label, _ in opened[kind].colours} == {*plots, 'robot'}
    for label, colours in opened[kind].colours:
        # Frame, ticks and text alone have some shades of grey: the robot's light has hundreds.
        assert colours > (200 if label == 'robot' else 20), label


def test_the_robot_moves_with_the_cursor(page: Page):
    end = page.data['duration']

    def last_frame(time: float) -> list[float]:
        page.ask(f'PAGE.timeline.setCursor({time})')
        return list(page.ask('Array.from(PAGE.view.pose(DATA.world.robots[0], 6))'))

    assert last_frame(0.0) != last_frame(end)
    assert last_frame(0.0) == last_frame(-1.0)


def test_rotations_between_poses_stay_rotations(page: Page):
    for time in (0.31, 0.777, 1.234):
        page.ask(f'PAGE.timeline.setCursor({time})')
        m = page.ask('Array.from(PAGE.view.pose(DATA.world.robots[0], 4))')
        columns = [m[0:3], m[4:7], m[8:11]]
        for i, a in enumerate(columns):
            for j, b in enumerate(columns):
                # WebGL's matrices are of single precision.
                assert sum(x * y for x, y in zip(a, b, strict=True)) == pytest.approx(float(i == j), abs=1e-5)


def test_dragging_zooms_all_panels_and_double_click_shows_all(page: Page):
    page.ask('PAGE.timeline.reset()')
    canvas = 'PAGE.panels[1].canvas'
    page.ask(f"{canvas}.dispatch('pointerdown', {{ clientX: 300 }})")
    page.ask(f"{canvas}.dispatch('pointermove', {{ clientX: 500 }})")
    page.ask(f"{canvas}.dispatch('pointerup', {{ clientX: 500 }})")
    start, end = page.ask('[PAGE.timeline.start, PAGE.timeline.end]')
    whole = page.data['duration']
    # 900 px wide, 62 left and 12 right of the plot.
    assert start == pytest.approx((300 - 62) / 826 * whole)
    assert end == pytest.approx((500 - 62) / 826 * whole)
    assert page.ask('PAGE.panels[3].x(PAGE.timeline.end)') == pytest.approx(900 - 12)
    page.ask(f"{canvas}.dispatch('dblclick', {{}})")
    assert page.ask('[PAGE.timeline.start, PAGE.timeline.end]') == [0, whole]


def test_playing_takes_the_time_it_took(page: Page):
    page.ask('PAGE.timeline.setCursor(0)')
    page.ask('PAGE.timeline.play(true)')
    page.ask('nextFrame(500)')
    assert page.ask('PAGE.timeline.cursor') == pytest.approx(0.5)
    page.ask('nextFrame(1e6)')
    assert page.ask('[PAGE.timeline.cursor, PAGE.timeline.playing]') == [page.data['duration'], False]


def test_a_click_on_a_line_shows_its_time(page: Page):
    rows = (
        "all(document.getElementById('report'), (e) => e.tagName === 'TR' && e.dataset.start !== undefined)"
    )
    page.ask(f"{rows}[2].dispatch('click', {{}})")
    shown = page.ask('[PAGE.timeline.start, PAGE.timeline.end, PAGE.timeline.cursor]')
    start = page.ask(f'{rows}[2].dataset.start')
    assert shown[0] <= start == shown[2] <= shown[1]
    page.ask('PAGE.timeline.reset()')


def test_curves_hold_what_was_recorded(bags: tuple[Path, Path], texts: dict[str, str]):
    page, report = Page(texts['report']), run_report(bags[0])
    speed = next(i for i, panel in enumerate(page.data['panels']) if panel['title'] == 'Tool speed')
    y = page.ask(f'Array.from(PAGE.panels[{speed}].series[1].y)')
    highest = float(report.signals.tool_speed.max())
    # 16 bits of the range, rounded, and single precision.
    assert y == pytest.approx(report.signals.tool_speed.tolist(), abs=highest * 1e-5)


def test_a_page_is_small(texts: dict[str, str]):
    for text in texts.values():
        assert len(text) < 3_000_000


def test_a_page_that_cannot_be_written_says_where(tmp_path: Path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(RobotsError, match=r'cannot be written to .*file'):
        write_page(tmp_path / 'file' / 'report.html', '')

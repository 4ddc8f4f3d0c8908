"""Size of a report's page and time until it is open, next to viser's export of the same moving robot.

Run by `make benchmark-report`. The page is that of the welding program. viser's `StateSerializer.as_html`
gets the robot's frames at the same rate as the page has them; plots and tables it does not have. Both are
opened from the disk, in a Chromium without a graphics card, until two pictures are drawn.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from importlib.resources import files
from pathlib import Path

from playwright.sync_api import Browser
from rich.console import Console
from rich.table import Table

from installed_browsers import browser
from robots_controller.report.page import page as report_pages
from robots_controller.report.page.page_world import POSES_PER_SECOND
from robots_controller.report.run_report import RunReport, run_report
from robots_controller.simulate import simulate
from robots_core.blocks.visualizer import Visualizer

PROGRAM = Path(__file__).parents[2] / 'programs' / 'welding.lua'
ROBOT = 'kuka_kr210_r2700'
REPETITIONS = 5
DRAWN = 'new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))'


def exported(report: RunReport) -> str:
    """The robot's motion as viser exports it."""
    run = report.run
    visualizer = Visualizer(run.robot, port=0)
    serializer = visualizer._server.get_scene_serializer()
    step = max(1, round(len(run.time) / (POSES_PER_SECOND * run.duration)))
    for q in run.feedback[0][::step]:
        visualizer.update(q)
        serializer.insert_sleep(1.0 / POSES_PER_SECOND)
    text = serializer.as_html()
    visualizer._server.stop()
    return text


def opened(running: Browser, file: Path) -> float:
    """Time until a page is drawn, s, median."""
    times = []
    for _ in range(REPETITIONS + 1):
        page = running.new_page()
        start = time.perf_counter()
        page.goto(file.as_uri())
        page.wait_for_selector('canvas')
        page.evaluate(DRAWN)
        times.append(time.perf_counter() - start)
        page.close()
    return statistics.median(times[1:])


def code_of_the_export(text: str) -> int:
    """Bytes without the data."""
    data = text.partition('__VISER_EMBED_DATA__="')[2].partition('"')[0]
    return len(text) - len(data)


def main() -> None:
    """Print the table."""
    sources = files(report_pages.__package__)
    names = (*report_pages.SCRIPTS, 'style.css', 'page.html')
    own = sum(len((sources / name).read_bytes()) for name in names)
    with tempfile.TemporaryDirectory() as folder, browser('--disable-gpu') as running:
        simulate(PROGRAM, robot=ROBOT, bag=Path(folder, 'bag'))
        report = run_report(Path(folder, 'bag'))
        export = exported(report)
        pages = {
            'report': (report_pages.report_page(report), own),
            "viser's export": (export, code_of_the_export(export)),
        }
        table = Table('page', 'size', 'of which code', 'open after', title=f'{report.run.duration:.1f} s')
        for name, (text, code) in pages.items():
            file = Path(folder, f'{len(text)}.html')
            file.write_text(text, encoding='utf-8')
            seconds = opened(running, file)
            table.add_row(name, f'{len(text) / 1e6:.2f} MB', f'{code / 1e6:.2f} MB', f'{seconds:.2f} s')
    Console().print(table)


if __name__ == '__main__':
    main()

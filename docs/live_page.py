"""The moving picture of the README: a simulated program in the page of the visualizer, drawn by Chromium.

Run by `make picture`.
"""

from __future__ import annotations

import argparse
import contextlib
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image
from viser import ViserServer

from robots_controller.simulate import simulate
from robots_core import load_robot_model
from robots_core.blocks.visualizer import Visualizer
from robots_core.errors import RobotsError

CHROMES: Final = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')
# A machine without a graphics card draws in software.
OPTIONS: Final = (
    *('--headless=new', '--no-sandbox', '--no-first-run', '--disable-background-networking'),
    *('--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'),
)
SIZE: Final = (640, 520)  # pixels
FRAMES: Final = 10.0  # per second of the picture
SPEED: Final = 1.5  # seconds of the program per second of the picture
LAST: Final = 1500  # ms, of the last frame
DEADLINE: Final = 300.0  # s
SETTLING: Final = 3.0  # s


def main() -> None:
    """Simulate a program, and write an animated WebP of the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('program', type=Path)
    parser.add_argument('robot')
    parser.add_argument('picture', type=Path)
    options = parser.parse_args()
    run = simulate(options.program, robot=options.robot)
    moves = np.abs(run.velocity).max(axis=1) > 1e-3
    first, last = np.flatnonzero(moves)[[0, -1]]
    rows = np.arange(first, last, round(SPEED / (FRAMES * run.period)))
    visualizer = Visualizer(load_robot_model(options.robot), port=0)
    with page_in_chromium(visualizer.url):
        wait_for_camera(visualizer, run.position[first])
        frames = [drawn(visualizer, run.position[row]) for row in rows]
    visualizer.close()
    times = [round(1e3 / FRAMES)] * (len(frames) - 1) + [LAST]
    frames[0].save(
        options.picture, save_all=True, append_images=frames[1:], duration=times, loop=0, quality=55, method=6
    )
    print(f'{options.picture}: {len(frames)} frames, {options.picture.stat().st_size / 1024:.0f} kB')


@contextlib.contextmanager
def page_in_chromium(url: str) -> Iterator[None]:
    """Show the page in a headless Chromium."""
    chromium = next((path for name in CHROMES if (path := shutil.which(name))), None)
    if chromium is None:
        raise RobotsError(f'no browser found; the picture needs one of {", ".join(CHROMES)}')
    with tempfile.TemporaryDirectory() as profile:
        command = [
            chromium,
            *OPTIONS,
            f'--user-data-dir={profile}',
            f'--window-size={SIZE[0]},{SIZE[1]}',
            url,
        ]
        process = subprocess.Popen(  # noqa: S603  # a browser of this machine, and our own page
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            yield
        finally:
            process.terminate()
            process.wait()


def wait_for_camera(visualizer: Visualizer, q: np.ndarray) -> None:
    """The page moves its camera and loads the robot after it has connected: wait until its view rests."""
    before = None
    while (image := drawn(visualizer, q)) != before:
        before = image
        time.sleep(SETTLING)


def drawn(visualizer: Visualizer, q: np.ndarray) -> Image.Image:
    """The view of the page with the robot at joint positions."""
    visualizer.update(q)
    server: ViserServer = visualizer._server  # noqa: SLF001  # the page offers no pictures to users
    deadline = time.monotonic() + DEADLINE
    while not (clients := server.get_clients()):
        if time.monotonic() > deadline:
            raise RobotsError(f'the browser has not opened the page within {DEADLINE:g} s')
        time.sleep(0.1)
    client = next(iter(clients.values()))
    return Image.fromarray(client.get_render(SIZE[1], SIZE[0], timeout=DEADLINE))


if __name__ == '__main__':
    main()

"""pendant_node is killed while somebody jogs on its page."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from installed_browsers import browser

from .browser_page import open_page, press, take_control
from .page_cell import PAGE, Cell

PENDANT = 'import sys; from robots_controller.nodes.pendant_node import main; sys.exit(main())'


def test_the_robot_stands_when_the_node_is_killed_while_somebody_jogs(ros_nodes: Any, tmp_path: Path) -> None:
    cell = Cell(ros_nodes, tmp_path)
    options = [word for name, value in PAGE.items() for word in ('-p', f'{name}:={value}')]
    words = [sys.executable, '-P', '-c', PENDANT, '--ros-args', *options]
    process = subprocess.Popen(words)
    try:
        ros_nodes.wait_for(lambda: cell.pages, what='the address of the page')
        with browser('--disable-gpu') as running:
            page = open_page(running, cell.pages[-1])
            page.get_by_text('connected', exact=True).wait_for()
            take_control(page)
            page.locator('.jog-panel .rows:not(.blocked)').wait_for()
            while not cell.moving:  # a busy machine may end a press
                press(page, '[data-press="axes 0 +"]')
                page.wait_for_timeout(100.0)
            process.send_signal(signal.SIGKILL)
            process.wait()
            ros_nodes.wait_for(lambda: not cell.moving, what='it stands')
            page.get_by_text('Connection lost').wait_for()
            page.context.close()
    finally:
        process.kill()
        process.wait()

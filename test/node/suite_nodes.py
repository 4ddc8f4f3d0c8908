"""All nodes of the suite, for what must hold of each."""

from __future__ import annotations

from functools import cache, partial
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Final

from robots_controller.live_cell.cell_monitor import CellMonitor
from robots_core.ros.running.run import run

CABIN: Final = str(Path('programs/motion_simulator/cabin.yaml').resolve())
CONTACT: Final = str(Path('programs/wheel_laboratory/regolith_simulant.yaml').resolve())
OPTIONS: Final[dict[str, dict[str, Any]]] = {
    'visualizer_node': {'port': 0},
    'pendant_node': {'port': 0},
    'io_bridge_node': {'io_map': str(Path('robots_controller/config/io_map_words.yaml').resolve())},
    'force_control_node': {'contact': CONTACT},
    'motion_cueing_node': {'cabin': CABIN},
    'wheel_soil_node': {'contact': CONTACT},
    'plc_node': {'script': str(Path('programs/io/press_tending.yaml').resolve())},
}
PACKAGES: Final = ('robots_core', 'robots_planning', 'robots_controller')


@cache
def suite_nodes() -> dict[str, Any]:
    """All nodes of the suite that take messages, by executable, and what listens in `cell`."""
    found = {}
    for package in PACKAGES:
        for entry in entry_points(group='console_scripts'):
            if entry.value.startswith(f'{package}.'):
                main = entry.load()
                if isinstance(main, partial) and main.func is run:
                    found[entry.name] = main.args[0]
    return {**found, 'cell_monitor': partial(CellMonitor, namespace='/')}

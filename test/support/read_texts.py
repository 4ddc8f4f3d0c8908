"""Files of inputs and outputs from their texts."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from robots_controller.io.io_map import IoMap, read_io_map
from robots_controller.io.plc_script import PlcScript, read_plc_script


def parse_io_map(text: str, file: str = 'io_map.yaml') -> IoMap:
    """The map of a text."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_text(text)
        return read_io_map(path)


def parse_plc_script(text: str, file: str = 'plc.yaml') -> PlcScript:
    """The script of a text."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_text(text)
        return read_plc_script(path)

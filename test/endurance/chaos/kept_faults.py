"""KeptFaults: faults that were tried, in a file, so that a long run may be interrupted and continued."""

import json
from dataclasses import asdict
from pathlib import Path

from .judgement import FaultFigures
from .summary import Fault

Key = tuple[int, str, str, int, str]
"""Seed, surroundings, program, number and node of a trial."""


class KeptFaults:
    """Faults by their trials, each a line of JSON.

    Args:
        path: The file; None keeps them in memory alone.
    """

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._faults: dict[Key, Fault] = {}
        if path is not None and path.exists():
            for line in path.read_text(encoding='utf-8').splitlines():
                seed, surroundings, program, number, node, killed, figures = json.loads(line)
                figures['problems'] = tuple(figures['problems'])
                fault = Fault(surroundings, node, killed, FaultFigures(**figures))
                self._faults[seed, surroundings, program, number, node] = fault

    @property
    def faults(self) -> list[Fault]:
        """All of them."""
        return [*self._faults.values()]

    def __contains__(self, key: Key) -> bool:
        return key in self._faults

    def add(self, key: Key, fault: Fault) -> None:
        """Keep one more."""
        self._faults[key] = fault
        if self._path is not None:
            with self._path.open('a', encoding='utf-8') as file:
                file.write(json.dumps([*key, fault.killed, asdict(fault.figures)]) + '\n')

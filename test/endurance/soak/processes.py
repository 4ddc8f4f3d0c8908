"""Memory of the processes of a cell, from /proc."""

import re
from pathlib import Path

from node_pids import node_pids


def memory_of(cell: int) -> dict[str, float]:
    """MB by process: of `cell`, and of each of its nodes; what has ended meanwhile is missing."""
    found = {}
    for name, pid in {'cell': cell, **node_pids(cell)}.items():
        try:
            status = Path(f'/proc/{pid}/status').read_text()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if size := re.search(r'^RssAnon:\s*(\d+) kB', status, re.MULTILINE):
            found[name] = int(size[1]) / 1024.0
    return found

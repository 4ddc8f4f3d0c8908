"""Processes of a running cell."""

from pathlib import Path


def node_pids(cell: int) -> dict[str, int]:
    """Processes of running nodes by name, forked from the server that the process of `cell` has started."""
    parents: dict[int, int] = {}
    pids: dict[int, str] = {}
    for stat in Path('/proc').glob('[0-9]*/stat'):
        try:
            state, parent = stat.read_text().rsplit(')', 1)[1].split()[:2]
            title = (stat.parent / 'cmdline').read_bytes().replace(b'\0', b' ').decode().split(' ')[0]
        except (FileNotFoundError, ProcessLookupError):
            continue
        pid = int(stat.parent.name)
        parents[pid] = int(parent)
        if state != 'Z' and title.endswith(('_node', '_nodes')):
            pids[pid] = Path(title).name
    return {name: pid for pid, name in pids.items() if parents.get(parents[pid]) == cell}

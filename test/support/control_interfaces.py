"""control_msgs, cut down to what concerns an arm, built from definitions of the tests and imported."""

from __future__ import annotations

import fcntl
import hashlib
import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from built_messages import build_messages

PACKAGE = 'control_msgs'
DEFINITIONS = Path(__file__).parent / 'interfaces' / PACKAGE
USES = (
    *('geometry_msgs', 'trajectory_msgs', 'std_msgs', 'builtin_interfaces'),
    *('action_msgs', 'unique_identifier_msgs', 'service_msgs'),
)


@pytest.fixture(scope='module')
def control_msgs(pytestconfig: pytest.Config) -> Iterator[None]:
    """The package can be imported. It is built once for what it is made from, and stays in pytest's cache."""
    cache = pytestconfig.cache
    assert cache is not None
    folder = cache.mkdir(f'{PACKAGE}-{_sources()}')
    built = folder / 'built'
    with (folder / 'lock').open('w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not built.exists():
            messages, actions = (
                {path.stem: path.read_text() for path in DEFINITIONS.glob(f'*.{kind}')}
                for kind in ('msg', 'action')
            )
            made = folder / 'made'
            shutil.rmtree(made, ignore_errors=True)  # of a run that was ended
            made.mkdir()
            path = build_messages(made, PACKAGE, messages, USES, actions)
            built.write_text(str(path.relative_to(folder)))
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder / built.read_text())
        yield
    for name in [name for name in sys.modules if name.partition('.')[0] == PACKAGE]:
        del sys.modules[name]


def _sources() -> str:
    """Of all that the package is made from: another one is built where any of it has changed."""
    found = hashlib.sha256()
    for path in (*sorted(DEFINITIONS.iterdir()), Path(build_messages.__code__.co_filename)):
        found.update(path.read_bytes())
    for part in (sys.version, sys.prefix, np.__version__, *(version(name) for name in ('rclpy', 'std_msgs'))):
        found.update(part.encode())
    return found.hexdigest()[:16]

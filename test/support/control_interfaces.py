"""control_msgs, cut down to what concerns an arm, built from definitions of the tests and imported."""

from __future__ import annotations

import fcntl
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from built_messages import build_messages

PACKAGE = 'control_msgs'
DEFINITIONS = Path(__file__).parent / 'interfaces' / PACKAGE
USES = (
    *('geometry_msgs', 'trajectory_msgs', 'std_msgs', 'builtin_interfaces'),
    *('action_msgs', 'unique_identifier_msgs', 'service_msgs'),
)


@pytest.fixture(scope='module')
def control_msgs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """The package can be imported. It is built once, for all processes of a run of tests."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if own.name.startswith('popen-') else own) / PACKAGE
    folder.mkdir(exist_ok=True)
    built = folder / 'built'
    with (folder / 'lock').open('w') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not built.exists():
            messages, actions = (
                {path.stem: path.read_text() for path in DEFINITIONS.glob(f'*.{kind}')}
                for kind in ('msg', 'action')
            )
            path = build_messages(folder, PACKAGE, messages, USES, actions)
            built.write_text(str(path))
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(built.read_text())
        yield
    for name in [name for name in sys.modules if name.partition('.')[0] == PACKAGE]:
        del sys.modules[name]

"""Numba, loaded in less time than its import takes."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Final

from robots_core.kernels.blas_modules import load_blas_modules

MANY: Final = 20_000  # objects, which the collector looks through in some milliseconds


@contextmanager
def garbage_kept() -> Iterator[None]:
    """Collect no garbage: Numba keeps what it creates at its import and with its first function."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            if gc.get_count()[0] > MANY:
                _let_new_objects_be_old()
            gc.enable()


def _let_new_objects_be_old() -> None:
    """Spare the collector to look through what is new."""
    # All that is frozen is counted one by one: 50 ms in a process that has frozen what it has loaded.
    frozen = gc.get_freeze_count() > 0
    gc.freeze()
    if not frozen:
        gc.unfreeze()


@contextmanager
def _without(module: str) -> Iterator[None]:
    """Imports of a module fail, unless it is imported already."""
    if module in sys.modules:
        yield
        return
    sys.modules[module] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[module]


def _load_numba() -> Any:
    # Numba imports coverage wherever it is installed, as a dependency of colcon is; it is used by
    # processes that have imported it before.
    with garbage_kept(), _without('coverage'):
        numba = import_module('numba')
        load_blas_modules()
    return numba


nb: Final = _load_numba()

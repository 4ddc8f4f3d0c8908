"""Numba, loaded in less time than its import takes."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Final

from robots_core.garbage import garbage_kept
from robots_core.kernels.blas_modules import load_blas_modules


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

"""Numba, loaded in less time than its import takes."""

import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, Final

from robots_core.garbage import garbage_kept

PACKAGE: Final = 'scipy.linalg'
MODULES: Final = ('cython_blas', 'cython_lapack')


def _load_blas_modules() -> None:
    """Import `MODULES` alone, where `scipy.linalg` is not imported yet.

    Numba imports them with its first compiled function, whether that uses them or not. All of `scipy.linalg`
    would take a quarter of the time until the first result of a process, and these are two files that need
    nothing of it. It is imported as usual where it is used.
    """
    if PACKAGE in sys.modules:
        return
    with suppress(ImportError):  # Numba does without
        spec = find_spec(PACKAGE)
        if spec is None or PACKAGE in sys.modules:
            return
        package = ModuleType(PACKAGE)
        package.__path__ = list(spec.submodule_search_locations or ())
        sys.modules[PACKAGE] = package
        try:
            for name in MODULES:
                import_module(f'{PACKAGE}.{name}')
        finally:
            del sys.modules[PACKAGE]


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
    with garbage_kept(), _without('coverage'), ThreadPoolExecutor(1) as thread:
        # On a stack that is empty, as that of a new thread: where it is as deep as one of its chunks, CPython
        # allocates and frees the next one at every call, which can take 0.1 s here.
        numba = thread.submit(import_module, 'numba').result()
        _load_blas_modules()
    return numba


nb: Final = _load_numba()

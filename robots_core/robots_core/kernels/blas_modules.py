"""SciPy's modules of BLAS and LAPACK functions, without the rest of `scipy.linalg`."""

import sys
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Final

PACKAGE: Final = 'scipy.linalg'
MODULES: Final = ('cython_blas', 'cython_lapack')


def load_blas_modules() -> None:
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

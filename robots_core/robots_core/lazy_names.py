"""Names that a package hands on, each imported when it is first asked for (PEP 562)."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any


def lazy_names(
    package: str, names: Mapping[str, Sequence[str]]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package that hands on names of its modules.

    A process that uses one module of a package need not load the others, and what they load.

    Args:
        package: The package's `__name__`.
        names: For each module, the names that the package hands on.

    Returns:
        `__getattr__` and `__dir__`.
    """
    modules = {name: module for module, its_names in names.items() for name in its_names}

    def get(name: str) -> Any:
        if name not in modules:
            raise AttributeError(f'module {package!r} has no attribute {name!r}', name=name)
        return getattr(import_module(modules[name]), name)

    def names_of_package() -> list[str]:
        return sorted({*vars(sys.modules[package]), *modules})

    return get, names_of_package

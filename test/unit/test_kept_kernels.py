"""Compiled functions of all packages: the build compiles them, and their annotations name their types."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, get_args, get_type_hints

from robots_core.kernels.compiled import compiled
from robots_core.kernels.kernel_cache import Dispatcher

PACKAGES = ('robots_core', 'robots_models', 'robots_planning', 'robots_controller')
DECORATOR = '\n@compiled('
BUILT = Path(__file__).parents[2] / 'install' / '.compiled'


@compiled()
def not_called(value: float) -> float:
    return 2.0 * value


@cache
def kernels() -> dict[str, Any]:
    """All compiled functions, by module and name."""
    found: dict[str, Any] = {}
    for package in PACKAGES:
        spec = find_spec(package)
        assert spec is not None
        root = Path(next(iter(spec.submodule_search_locations or ())))
        for file in sorted(root.rglob('*.py')):
            count = file.read_text().count(DECORATOR)
            if count:
                name = '.'.join((package, *file.relative_to(root).with_suffix('').parts))
                own = {f'{name}.{key}': value for key, value in vars(import_module(name)).items()}
                own = {
                    key: value
                    for key, value in own.items()
                    if isinstance(value, Dispatcher) and value.py_func.__module__ == name
                }
                assert len(own) == count, f'{name} has compiled functions that are no names of it'
                found |= own
    return found


def is_kept(kernel: Any, until: float) -> bool:
    """Whether machine code of a function was kept until then; tests may have compiled it since."""
    kept = kernel._cache._cache_file
    files = (Path(kept._data_path(name)) for name in kept._load_index().values())
    return any(file.exists() and file.stat().st_mtime <= until for file in files)


def named_tuples(compiled_for: Any) -> Iterator[type]:
    """Those within one of Numba's types."""
    if hasattr(compiled_for, 'instance_class'):
        yield compiled_for.instance_class
    for part in getattr(compiled_for, 'types', ()):
        yield from named_tuples(part)


def annotated_types(annotation: Any) -> Iterator[type]:
    """The types within an annotation."""
    if isinstance(annotation, type):
        yield annotation
        if issubclass(annotation, tuple):
            for field in get_type_hints(annotation).values():
                yield from annotated_types(field)
    for part in get_args(annotation):
        yield from annotated_types(part)


def test_the_build_compiles_all_kernels():
    """Whatever it leaves out is compiled where it is first used, such as in the control loop."""
    built = BUILT.stat().st_mtime
    left_out = [name for name, kernel in kernels().items() if not is_kept(kernel, built)]
    assert not left_out, f'robots_planning/warm_up.py, or a build that is old, has left out {left_out}'


def test_a_kernel_that_was_not_compiled_is_found():
    assert not is_kept(not_called, BUILT.stat().st_mtime)


def test_annotations_name_the_named_tuples_that_kernels_are_compiled_for():
    """By their fields, which machine code reads by place, kept code is recognised."""
    unnamed = []
    for name, kernel in kernels().items():
        known = set(annotated_types(tuple[*get_type_hints(kernel.py_func).values()]))
        for signature, *_ in kernel._cache._cache_file._load_index():
            arguments = getattr(signature, 'args', signature)
            taken = {one for argument in arguments for one in named_tuples(argument)}
            unnamed += [(name, one) for one in taken - known]
    assert not unnamed

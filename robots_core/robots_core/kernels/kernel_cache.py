"""Machine code kept by the content of the functions that it is made of.

Numba keeps compiled code as long as the file of its function has the same time and size: code made of
functions of other files becomes stale, and any edit of a file compiles all of it again. Here the key is a
digest of the function's bytecode, of its options and the types of its arguments, of the constants that it
uses, and of the compiled functions that it calls.
"""

import hashlib
import sys
import types
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, ForwardRef, Self, get_args

import numpy as np

from robots_core.kernels.loaded_numba import nb

caching = nb.core.caching
Dispatcher = nb.core.dispatcher.Dispatcher
LIBRARIES = {'builtins', 'math', 'numpy', 'numba'}  # whose functions change with Numba's own version alone

_CONTENTS: dict[Callable[..., Any], 'KernelContent'] = {}
_PLACES = (caching.UserProvidedCacheLocator, caching.InTreeCacheLocator, caching.UserWideCacheLocator)


class KernelContent:
    """What the machine code of a function is made of: the stamp that Numba compares with that of kept code.

    What the function uses is found when it is first compared: then the functions that it calls are defined,
    even those below it.

    Raises:
        TypeError: the type of an argument is not known when the function is defined.
    """

    def __init__(self, function: Callable[..., Any], **options: object) -> None:
        # Kept code names the modules of its functions and the types of their arguments, and cannot be read
        # without them.
        place = function.__module__, function.__qualname__
        annotated = _annotated(function, function.__globals__)
        self.own = _digest(place, annotated, sorted(options.items()), *_code(function))
        self._function = function
        self._whole = ''

    @property
    def whole(self) -> str:
        """Digest of all.

        Raises:
            TypeError: the function uses a value whose content is not known.
        """
        if not self._whole:
            self._whole = _digest(self.own, *_used(self._function))
        return self._whole

    def __eq__(self, other: object) -> bool:
        return self.whole == other

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type, tuple[str]]:
        """The digest alone is kept."""
        return str, (self.whole,)


class ContentLocator:
    """One of Numba's places for compiled code, in which code is recognised by its content."""

    def __init__(self, place: Any, content: KernelContent) -> None:
        self._place, self._content = place, content

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._place.get_cache_path())

    def ensure_cache_path(self) -> None:
        """Make the folder."""
        self._place.ensure_cache_path()

    def get_source_stamp(self) -> KernelContent:
        """What must be the same as when the code was compiled."""
        return self._content

    def get_disambiguator(self) -> str:
        """The part of a file's name in which functions of one name, and their versions, differ."""
        return self._content.own[:16]

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> Self | None:
        """In the first place that can be written to; None for functions of other packages."""
        content = _CONTENTS.get(function)
        if content is None:
            return None
        places = (place.from_function(function, file) for place in _PLACES)
        return next((cls(place, content) for place in places if place is not None), None)


# For numba.config.CACHE_LOCATOR_CLASSES: the first one that takes a function.
CACHE_LOCATORS = ','.join((f'{__name__}.{ContentLocator.__name__}', *(place.__name__ for place in _PLACES)))


def keep_by_content(function: Callable[..., Any], **options: object) -> None:
    """Let the machine code of a function, compiled with these options, be kept by its content."""
    _CONTENTS[function] = KernelContent(function, **options)


def _digest(*parts: object) -> str:
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _annotated(annotated: Any, names: dict[str, Any]) -> list[object]:
    """The types in the annotations of a function or a class, which may be written as text of these names."""
    annotations = getattr(annotated, '__annotations__', {})
    return [(name, _type(_evaluated(one, names))) for name, one in annotations.items()]


def _evaluated(annotation: Any, names: dict[str, Any]) -> Any:
    text = getattr(annotation, '__forward_arg__', annotation)
    if not isinstance(text, str):
        return annotation
    try:
        return eval(text, names)  # noqa: S307  # a part of the source
    except (NameError, AttributeError) as error:
        raise TypeError(
            f'the annotation {text!r} is not known: {error}; compiled functions take types that are defined '
            f'above them or imported, and not for type checkers alone'
        ) from error


@cache
def _type(annotation: Any) -> tuple[object, ...]:
    """With the fields of named tuples: compiled code reads them by place, and Numba compares types alone."""
    if isinstance(annotation, str | ForwardRef):
        raise TypeError(
            f'{annotation!r} is text within an annotation; all of an annotation is text, or nothing'
        )
    if isinstance(annotation, type) and issubclass(annotation, tuple):
        fields = [_annotated(base, vars(sys.modules[base.__module__])) for base in annotation.__mro__]
        return annotation.__module__, annotation.__qualname__, getattr(annotation, '_fields', ()), fields
    return str(annotation), [_type(part) for part in get_args(annotation)]


def _code(function: Any) -> Iterator[object]:
    for code in _codes(function.__code__):
        yield code.co_code, code.co_names, code.co_varnames
        constants = code.co_consts[1:] if code.co_consts[0] == function.__doc__ else code.co_consts
        yield [constant for constant in constants if not isinstance(constant, types.CodeType)]


def _codes(code: types.CodeType) -> Iterator[types.CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _codes(constant)


def _used(function: Any) -> Iterator[object]:
    cells = (cell.cell_contents for cell in function.__closure__ or ())
    used = dict(zip(function.__code__.co_freevars, cells, strict=True))
    for code in _codes(function.__code__):
        used |= {name: function.__globals__[name] for name in code.co_names if name in function.__globals__}
    for name, value in sorted(used.items()):
        if getattr(value, 'py_func', None) is not function:  # it may call itself
            yield name, _value(name, value)
    yield [_value('a default value', value) for value in function.__defaults__ or ()]


def _value(name: str, value: object) -> object:
    content: object = value
    is_module = isinstance(value, types.ModuleType)
    home = getattr(value, '__name__' if is_module else '__module__', '')
    if isinstance(value, Dispatcher):
        content = _CONTENTS[value.py_func].whole
    elif isinstance(value, np.ndarray):
        content = repr(value.dtype), value.shape, value.tobytes()
    elif isinstance(value, tuple):
        content = [_type(type(value)), *(_value(name, item) for item in value)]
    elif isinstance(value, type) and issubclass(value, tuple):
        content = _type(value)
    elif home.partition('.')[0] in LIBRARIES:
        content = home if is_module else (home, getattr(value, '__qualname__', repr(value)))
    elif not isinstance(value, int | float | str | None):
        raise TypeError(
            f'{name} is of {type(value).__name__}: compiled functions use numbers, strings, arrays, tuples '
            f'and their types, compiled functions, and functions of math, numpy and numba'
        )
    return content

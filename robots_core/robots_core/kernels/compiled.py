"""Compilation of functions to machine code by Numba, kept on disk."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

from robots_core.garbage import garbage_kept
from robots_core.kernels.kernel_cache import CACHE_LOCATORS, keep_by_content
from robots_core.kernels.loaded_numba import nb

Function = TypeVar('Function', bound=Callable[..., Any])

nb.config.CACHE_LOCATOR_CLASSES = CACHE_LOCATORS


def compiled(
    *signatures: Any, nogil: bool = True, counted: bool = True, inlined: bool = False
) -> Callable[[Function], Function]:
    """Compile a function by Numba: immediately with signatures, else on the first call.

    Args:
        signatures: Numba's signatures, of the arguments that the function is compiled for.
        nogil: Other threads run meanwhile, which costs 0.05 us per call.
        counted: References to arrays are counted, which costs 10 ns for each in a call that is not inlined.
            Without, the function can neither make arrays nor return any.
        inlined: The code is part of that of each function that calls it, and so is that of functions that are
            compiled with it.

    The code is kept beside the source, or in the user's cache folder if that is not writable (or in
    $NUMBA_CACHE_DIR), and is used until what it was made of changes: see `kernel_cache`. Without a writable
    folder, it is compiled again in every process.
    """

    def decorate(function: Function) -> Function:
        chosen = [list(signatures)] if signatures else []
        # Said in both cases: a function takes over options that are not set from the one that calls it first.
        options = {'nogil': nogil, '_nrt': counted} | ({'forceinline': True} if inlined else {})
        keep_by_content(function, **options)
        try:
            with garbage_kept():
                result = nb.njit(*chosen, cache=True, **options)(function)
        except RuntimeError as error:
            if 'cannot cache' not in str(error):
                raise
            result = nb.njit(*chosen, **options)(function)
        result.get_call_template = partial(_by_types_alone, result.get_call_template)
        kernel: Function = result
        return kernel

    return decorate


def _by_types_alone(find: Callable[..., Any], given: Sequence[Any], named: Mapping[str, Any]) -> Any:
    """How a function is called from compiled code."""
    # Numba's own way compiles it for each constant argument, which takes 7 to 10 % more time of `make build`.
    types = nb.types
    return find(
        [types.unliteral(one) for one in given], {name: types.unliteral(one) for name, one in named.items()}
    )


# Its signature lets Numba load here what it loads with a first function, while no garbage is collected.
@compiled('float64(float64)')
def first_function(value: float) -> float:
    """The value itself."""
    return value

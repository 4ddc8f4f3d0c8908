"""Compilation of functions to machine code by Numba, kept on disk."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

from numpy.typing import NDArray

from robots_core.garbage import garbage_kept
from robots_core.kernels.kernel_cache import CACHE_LOCATORS, keep_by_content
from robots_core.kernels.loaded_numba import nb

Function = TypeVar('Function', bound=Callable[..., Any])

nb.config.CACHE_LOCATOR_CLASSES = CACHE_LOCATORS


def compiled(*signatures: Any, nogil: bool = True, counted: bool = True) -> Callable[[Function], Function]:
    """Compile a function by Numba: immediately with signatures, else on the first call.

    Args:
        signatures: Numba's signatures, of the arguments that the function is compiled for.
        nogil: Other threads run meanwhile, which costs 0.05 us per call.
        counted: References to arrays are counted, which costs 10 ns for each in a call that is not inlined.
            Without, the function can neither make arrays nor return any.

    The code is kept beside the source, or in the user's cache folder if that is not writable (or in
    $NUMBA_CACHE_DIR), and is used until what it was made of changes: see `kernel_cache`. Without a writable
    folder, it is compiled again in every process.
    """

    def decorate(function: Function) -> Function:
        chosen = [list(signatures)] if signatures else []
        # Said in both cases: a function takes over options that are not set from the one that calls it first.
        options = {'nogil': nogil, '_nrt': counted, 'no_cfunc_wrapper': True}
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
    """How a function is called from compiled code: without this it is compiled for each constant argument."""
    types = nb.types
    return find(
        [types.unliteral(one) for one in given], {name: types.unliteral(one) for name, one in named.items()}
    )


# Its signatures load it here, and with it all that Numba loads with a first function, while no garbage is
# collected.
@compiled('void(int64[:])', 'void(float64[:])')
def sort_in_place(values: NDArray[Any]) -> None:
    """Sort a few values, (m,), by insertion.

    np.sort is not used: Numba names the internal functions of np.sort and np.argsort by a counter that
    restarts in every process, so that their cached code may be confused.
    """
    for i in range(1, values.size):
        value = values[i]
        k = i
        while k > 0 and values[k - 1] > value:
            values[k] = values[k - 1]
            k -= 1
        values[k] = value

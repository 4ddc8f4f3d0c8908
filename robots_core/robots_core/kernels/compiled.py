"""Compilation of functions to machine code by Numba, cached on disk."""

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numpy.typing import NDArray

Function = TypeVar('Function', bound=Callable[..., Any])


def compiled(*signatures: Any, nogil: bool = True, nrt: bool = True) -> Callable[[Function], Function]:
    """Compile a function by Numba: immediately with signatures, else on the first call.

    With `nogil` other threads run meanwhile, which costs 0.05 us per call. So does Numba's reference counting
    of each array argument in every function that calls another; functions that allocate no arrays can do
    without it (`nrt=False`). Speed profiles took 1.5 times as long with it. The code is cached beside the
    source, or in the user's cache folder if that is not writable (or in $NUMBA_CACHE_DIR). Without a writable
    folder, it is compiled again in every process.
    """

    def decorate(function: Function) -> Function:
        chosen = [list(signatures)] if signatures else []
        options = {'nogil': nogil, '_nrt': nrt}
        try:
            result: Function = numba.njit(*chosen, cache=True, **options)(function)
        except RuntimeError as error:
            if 'cannot cache' not in str(error):
                raise
            result = numba.njit(*chosen, **options)(function)
        return result

    return decorate


def entry_point(kernel: Function) -> Function:
    """The machine code of a kernel with one signature, without Numba's dispatch on argument types.

    A call takes 0.07 us less. An argument that is no array raises a TypeError; the caller is responsible for
    types and dimensions of arrays.
    """
    overloads = getattr(kernel, 'overloads', None)  # none where NUMBA_DISABLE_JIT leaves Python's function
    if not overloads:
        return kernel
    (only,) = overloads.values()
    code: Function = only.entry_point
    return code


@compiled()
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

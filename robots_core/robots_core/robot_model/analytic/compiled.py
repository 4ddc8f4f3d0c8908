"""Compilation of the closed forms to machine code, kept on disk."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba
from numpy.typing import NDArray

Function = TypeVar('Function', bound=Callable[..., Any])


def compiled(*signatures: Any, nogil: bool = True, nrt: bool = True) -> Callable[[Function], Function]:
    """Compile a function by Numba; with signatures at once, without when it is first called.

    Other threads run meanwhile if `nogil`; letting them takes a twentieth of a microsecond per call. So does
    counting the references to each array that comes in, by Numba's runtime, in every function that calls
    another: what makes no arrays itself does without (`nrt`). Speed profiles took 1.5 times as long with it.
    The code is kept beside the source, or in the user's cache folder where that cannot be written to (or
    in $NUMBA_CACHE_DIR). Where none can be written, it is compiled anew in every process.
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
    """The machine code of a kernel with one signature, without Numba's choice by the arguments' types.

    A call takes 0.07 microseconds less. What is no array is a TypeError; for types and numbers of dimensions
    of those that come in the caller answers.
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

    Not by np.sort: Numba gives the insides of np.sort and np.argsort names that differ by a counter alone,
    which starts anew in every process. Kept code of both may then be taken for each other.
    """
    for i in range(1, values.size):
        value = values[i]
        k = i
        while k > 0 and values[k - 1] > value:
            values[k] = values[k - 1]
            k -= 1
        values[k] = value

"""compiled: machine code with the function's own results, kept where there is a place for it."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest

from robots_core.kernels.compiled import compiled
from robots_core.kernels.loaded_numba import nb


def halved(values: np.ndarray) -> float:
    return float(values.sum()) / 2.0


@compiled()
def doubled(values: np.ndarray) -> np.ndarray:
    return values + values


@compiled(counted=False)
def last_of_doubled(values: np.ndarray) -> float:
    return doubled(values)[-1]


@compiled(counted=False)
def largest(rows: np.ndarray) -> float:
    result = rows[0, 0]
    for row in rows:
        for value in row:
            result = max(result, value)
    return result


def test_compiled_code_does_what_the_function_does():
    assert compiled()(halved)(np.arange(5.0)) == halved(np.arange(5.0))


def test_code_without_a_file_to_keep_it_beside_is_compiled_all_the_same():
    names: dict[str, Any] = {}
    exec('def doubled(value):\n    return 2.0 * value\n', names)  # noqa: S102  # a function without a file
    assert compiled('float64(float64)')(names['doubled'])(3.0) == 6.0


def test_code_that_counts_no_references_leaves_those_of_its_arrays_as_they_are():
    rows = np.arange(6.0).reshape(2, 3)
    before = sys.getrefcount(rows)
    assert largest(rows) == 5.0
    assert sys.getrefcount(rows) == before


def test_code_that_counts_no_references_makes_no_arrays():
    with pytest.raises(nb.core.errors.NumbaError):
        compiled(counted=False)(doubled.py_func)(np.ones(3))  # type: ignore[attr-defined]


def test_options_of_a_caller_do_not_hold_for_the_functions_that_it_calls():
    assert last_of_doubled(np.ones(3)) == 2.0

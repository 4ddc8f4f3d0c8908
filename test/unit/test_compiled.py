"""compiled: machine code with the function's own results, kept where there is a place for it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from robots_core.kernels.compiled import compiled, sort_in_place


def halved(values: np.ndarray) -> float:
    return float(values.sum()) / 2.0


def test_compiled_code_does_what_the_function_does():
    assert compiled()(halved)(np.arange(5.0)) == halved(np.arange(5.0))


def test_code_without_a_file_to_keep_it_beside_is_compiled_all_the_same():
    names: dict[str, Any] = {}
    exec('def doubled(value):\n    return 2.0 * value\n', names)  # noqa: S102  # a function without a file
    assert compiled('float64(float64)')(names['doubled'])(3.0) == 6.0


@pytest.mark.parametrize('dtype', [np.int64, np.float64])
@pytest.mark.parametrize('size', [0, 1, 2, 40])
def test_values_are_sorted_in_place(dtype: type, size: int) -> None:
    values = np.random.default_rng(size).integers(-9, 9, size).astype(dtype)
    expected = np.sort(values)
    sort_in_place(values)
    np.testing.assert_array_equal(values, expected)

"""Laws of the quadratic program: what it calls solved is the minimum, what it calls infeasible is."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from robots_core.blocks.inverse_kinematics.quadratic_program import (
    INFEASIBLE,
    SOLVED,
    solve_quadratic_program,
)


@settings(max_examples=300)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 8), rows=st.integers(0, 16))
@example(seed=514, n=8, rows=8)  # multipliers of 1e8 on the way to some of 1e2
def test_solution_fulfils_the_optimality_conditions(seed: int, n: int, rows: int) -> None:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, n)) * 10.0 ** rng.uniform(-3.0, 1.0, (n, 1))  # nearly singular ones too
    H, f = A.T @ A + 1e-6 * np.eye(n), A.T @ rng.normal(size=n)
    centre, width = rng.normal(size=n), rng.uniform(0.0, 1.0, n)
    low, high = centre - width, centre + width
    C = rng.normal(size=(rows, n))
    top = C @ (centre + rng.uniform(-0.5, 0.5, n) * width) + 0.3 * rng.normal(size=rows)
    # Narrow rows, wide ones and such with one side alone.
    bottom = top - rng.choice([0.0, 0.1, 3.0, np.inf], rows, p=[0.05, 0.1, 0.35, 0.5])
    x, multipliers = np.empty(n), np.empty(n + rows)
    status = solve_quadratic_program(
        H, f, np.concatenate([low, bottom]), np.concatenate([high, top]), C, x, multipliers
    )
    if status == INFEASIBLE:
        finite = np.isfinite(bottom)
        proof = linprog(
            np.zeros(n),
            A_ub=np.vstack([C, -C[finite]]),
            b_ub=np.concatenate([top, -bottom[finite]]),
            bounds=np.stack([low, high], axis=1),
        )
        assert proof.status == 2
        return
    assert status == SOLVED
    constraints = np.vstack([np.eye(n), C])
    values = constraints @ x
    over, under = np.concatenate([high, top]) - values, values - np.concatenate([low, bottom])
    assert min(over.min(), under.min()) >= -1e-9  # rounding of sums of terms of order one
    # Stationary, and a multiplier only where the gap of its side is closed; the multipliers reach 1e3 here.
    np.testing.assert_allclose(H @ x + f + constraints.T @ multipliers, 0.0, atol=1e-7)
    gap = np.where(multipliers > 0.0, over, np.where(multipliers < 0.0, under, 0.0))
    np.testing.assert_allclose(gap * multipliers, 0.0, atol=1e-7)

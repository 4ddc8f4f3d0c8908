"""How far a robot may be from the trajectory of a goal."""

from __future__ import annotations

import numpy as np

from robots_planning.commands.trajectory_goal import Tolerance

NAMES = ['A1', 'A2']
NONE = Tolerance.none(2)


def test_an_error_beyond_a_tolerance_is_named() -> None:
    tolerance = Tolerance(np.array([0.1, np.inf]), np.array([np.inf, 0.5]))
    assert tolerance.violation(np.array([0.1, 9.0]), np.array([9.0, -0.5]), NAMES) == ''
    assert tolerance.violation(np.array([-0.2, 0.0]), np.zeros(2), NAMES) == (
        'the position of A1 is -0.2 from its reference, allowed is 0.1'
    )
    assert 'the velocity of A2' in tolerance.violation(np.zeros(2), np.array([0.0, 0.6]), NAMES)
    assert NONE.violation(np.full(2, 1e9), np.full(2, 1e9), NAMES) == ''
    assert tolerance.given
    assert not NONE.given

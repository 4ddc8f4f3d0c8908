"""FollowedMotion: caps of motions that carry each other on."""

from __future__ import annotations

import numpy as np

from robots_controller.control.followed_motion import FollowedMotion
from robots_planning.timing.path_speed_cap import PathSpeedCap

from .two_axes import quintic, two_axes

AXES = two_axes((4.0, 3.0))
RAMP = 0.2  # s, in which the path speed falls from 1 to 0
PATH = quintic(np.zeros(2), np.array([1e-3, -1e-3]), 1.0)  # so short that the axes could stop at once


def capped(allowed: float) -> FollowedMotion:
    cap = PathSpeedCap.of(PATH, AXES.acceleration, RAMP, allowed)
    return FollowedMotion(PATH, str(allowed), cap)


def speed(motion: FollowedMotion, path_time: float) -> float:
    assert motion.cap is not None
    return motion.cap.here(path_time)


def test_a_slow_motion_slows_down_all_motions_from_which_it_takes_to_brake() -> None:
    first, short, slow = capped(1.0), capped(1.0), capped(0.1)
    first.join(short, 0.9, passes=True)
    assert speed(first, 0.9) == 1.0
    short.join(slow, 0.02, passes=True)
    assert speed(short, 0.02) == 0.1
    assert speed(first, 0.9) == speed(short, 0.0) < 0.9
    # No slower than it takes: by the ramp, from the motion's border on.
    assert speed(first, 0.5) == 1.0

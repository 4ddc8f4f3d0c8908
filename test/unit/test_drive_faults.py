"""DriveFaults: what each fault does to the reference and to the feedback."""

import numpy as np
import pytest

from robots_core.blocks.drives.drive_faults import DriveFaults, FaultInjection, known_axes
from robots_core.errors import InvalidInputError

NAMES = ('a', 'b', 'c')
Q, V = np.array([0.1, 0.2, 0.3]), np.array([1.0, 2.0, 3.0])


def test_without_faults_all_passes():
    injection = FaultInjection(NAMES)
    q, v = injection.reference(Q, V)
    np.testing.assert_array_equal((q, v), (Q, V))
    q, v, axes = injection.feedback(Q, V)
    np.testing.assert_array_equal((q, v), (Q, V))
    assert axes == [0, 1, 2]


def test_a_stopped_drive_stays_until_it_is_repaired():
    injection = FaultInjection(NAMES)
    injection.faults = DriveFaults(stopped=known_axes(NAMES, ['b']))
    injection.reference(Q, V)
    q, v = injection.reference(Q + 1.0, V)
    np.testing.assert_allclose(q, [1.1, 0.2, 1.3])
    np.testing.assert_array_equal(v, [1.0, 0.0, 3.0])
    injection.faults = DriveFaults()
    np.testing.assert_array_equal(injection.reference(Q + 2.0, V)[0], Q + 2.0)
    injection.faults = DriveFaults(stopped=known_axes(NAMES, ['b']))
    assert injection.reference(Q + 3.0, V)[0][1] == 3.2


def test_a_frozen_encoder_reports_one_position():
    injection = FaultInjection(NAMES)
    injection.faults = DriveFaults(frozen=known_axes(NAMES, ['c']))
    injection.feedback(Q, V)
    q, v, axes = injection.feedback(Q + 1.0, V)
    np.testing.assert_allclose(q, [1.1, 1.2, 0.3])
    np.testing.assert_array_equal(v, [1.0, 2.0, 0.0])
    assert axes == [0, 1, 2]


def test_a_lost_axis_does_not_report():
    injection = FaultInjection(NAMES)
    injection.faults = DriveFaults(lost=known_axes(NAMES, ['a', '']))
    assert injection.feedback(Q, V)[2] == [1, 2]


def test_noise_is_as_large_as_asked_for_and_the_same_again():
    runs = []
    for _ in range(2):
        injection = FaultInjection(NAMES, seed=4)
        injection.faults = DriveFaults(noise=0.01)
        runs.append(np.array([injection.feedback(Q, V)[0] - Q for _ in range(1000)]))
    np.testing.assert_array_equal(*runs)
    # 3000 samples: the deviation of the estimated deviation is 1.3 %, six of them are allowed.
    assert runs[0].std() == pytest.approx(0.01, rel=0.08)
    assert abs(runs[0].mean()) < 6.0 * 0.01 / np.sqrt(3000.0)


def test_bad_faults_are_named():
    with pytest.raises(InvalidInputError, match="no axis is called 'd'; axes are a, b, c"):
        DriveFaults(lost=known_axes(NAMES, ['d']))
    for noise in (-1.0, np.nan, np.inf):
        with pytest.raises(InvalidInputError, match='noise'):
            DriveFaults(noise=noise)

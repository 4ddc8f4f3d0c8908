"""Rows from a template are the bytes that serialization makes."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_controller.recording.message_rows import MessageRows, marks
from robots_controller.simulation.record import ros_messages as ros

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


@settings(max_examples=30)
@given(
    st.integers(1, 9).flatmap(
        lambda n: st.lists(
            st.tuples(st.integers(0, 2 * 10**18), st.lists(NUMBERS, min_size=3 * n, max_size=3 * n)),
            min_size=1,
            max_size=5,
        )
    ),
    # Names of any length move what comes behind them, to every alignment.
    st.text('abc', max_size=9),
)
def test_references_are_those_that_serialization_makes(samples: list[tuple[int, list[float]]], name: str):
    values = np.array([row for _, row in samples]).reshape(len(samples), 3, -1)
    n = values.shape[2]
    names = [f'{name}{i}' for i in range(n)]
    kind = 'trajectory_msgs/msg/JointTrajectory'
    template = [marks(n, i) for i in range(3)]
    rows = MessageRows(
        ros.typestore(), ros.BUILD.joint_trajectory(0, names, [(4_000_000, *template)]), template
    )
    stamps = np.array([stamp for stamp, _ in samples])
    filled = rows.fill(stamps, [values[:, i] for i in range(3)])
    for stamp, value, row in zip(stamps.tolist(), values, filled, strict=True):
        message = ros.BUILD.joint_trajectory(stamp, names, [(4_000_000, *value)])
        assert row.tobytes() == bytes(ros.typestore().serialize_cdr(message, kind))
    read = rows.read([row.tobytes() for row in filled])
    assert read is not None
    assert read[0].tolist() == stamps.tolist()
    assert np.array_equal(np.stack(read[1], axis=1), values)


def test_a_message_without_header_has_no_stamp():
    kind, mark = 'std_msgs/msg/Float64', marks(1, 0)
    template = ros.message(kind, float(mark[0]))
    rows = MessageRows(ros.typestore(), template, [mark])
    filled = rows.fill(np.array([1, 2]), [np.array([0.25, 0.5])])
    expected = [bytes(ros.typestore().serialize_cdr(ros.message(kind, x), kind)) for x in (0.25, 0.5)]
    assert [row.tobytes() for row in filled] == expected

"""The simulated times of recorded messages, however late a topic is read."""

from __future__ import annotations

from typing import Any, Final

from rosgraph_msgs.msg import Clock

from robots_controller.nodes.bags.lockstep_times import LockstepTimes

TICK: Final = 4_000_000  # ns, simulated
START: Final = 1_000_000_000  # ns, simulated
GAP: Final = 1_000  # ns of the system's clock between two instants


class Clocks:
    """`/clock` of instants 0, 1, ..., each sent `GAP` after the one before."""

    def __init__(self) -> None:
        self.sent, self._taken = 0, set[int]()
        self.late: list[int] = []
        """Instants whose clocks are still on the way."""

    def take_all(self) -> list[tuple[Clock, dict[str, int]]]:
        found = []
        came = [instant for instant in range(self.sent) if instant not in self.late]
        for instant in [instant for instant in came if instant not in self._taken]:
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(START + instant * TICK, 1_000_000_000)
            found.append((message, {'source_timestamp': instant * GAP}))
        self._taken.update(came)
        return found


def message(instant: int, after: int) -> Any:
    """A message that is sent so many ns after the clock of an instant."""
    return instant * GAP + after, None, f'{instant} {after}'.encode()


def test_a_topic_that_is_looked_at_before_the_others_keeps_its_instants() -> None:
    clocks = Clocks()
    times = LockstepTimes(clocks)
    clocks.sent = 2
    found = [*times.stamped([message(0, 1)], last=False)]
    # Before a second topic and the clock are read, two instants have passed, and a message has come on the
    # first topic, which was read already.
    clocks.sent = 4
    found += times.stamped([message(2, 7), message(3, 7)], last=False)
    clocks.sent = 5
    found += times.stamped([message(1, 5), message(2, 5)], last=False)
    found += times.stamped([], last=True)
    assert [(stamp // TICK * TICK, data.decode()) for stamp, _, data in found] == [
        (START, '0 1'),
        (START + TICK, '1 5'),
        (START + 2 * TICK, '2 5'),
        (START + 2 * TICK, '2 7'),
        (START + 3 * TICK, '3 7'),
    ]


def test_a_later_clock_of_another_sender_does_not_stand_for_those_that_are_late() -> None:
    clocks = Clocks()
    times = LockstepTimes(clocks)
    clocks.sent, clocks.late = 5, [2, 3, 4]
    found = [*times.stamped([message(1, 5), message(3, 5)], last=False)]
    # The five instants so far were those of a sender that now lets another one go on.
    times.expect(5, START + 4 * TICK)
    clocks.sent = 8
    assert times.missing == 3
    found += times.stamped([message(6, 5)], last=False)
    found += times.stamped([], last=False)
    assert [data.decode() for _, _, data in found] == []
    clocks.late = []
    found += times.stamped([], last=False)
    found += times.stamped([], last=False)
    assert times.missing == 0
    assert [(stamp // TICK * TICK, data.decode()) for stamp, _, data in found] == [
        (START + TICK, '1 5'),
        (START + 3 * TICK, '3 5'),
        (START + 6 * TICK, '6 5'),
    ]


def test_a_message_that_is_sent_again_keeps_its_instant_however_late_it_comes() -> None:
    clocks = Clocks()
    times = LockstepTimes(clocks)
    clocks.sent = 6
    found = [*times.stamped([message(1, 5), message(4, 5)], last=False)]
    found += times.stamped([], last=False)
    found += times.stamped([message(1, 3), message(4, 3)], last=True)
    assert [(stamp, data.decode()) for stamp, _, data in found] == [
        (START + TICK, '1 5'),
        (START + 4 * TICK, '4 5'),
        (START + TICK + 1, '1 3'),
        (START + 4 * TICK + 1, '4 3'),
    ]

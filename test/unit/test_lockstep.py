"""Lock-step without ROS: whose turn is next, what is still on its way, which periods are due."""

from __future__ import annotations

import math

import pytest

from robots_core.errors import InvalidInputError
from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS, PeriodicSchedule
from robots_core.ros.lockstep.agenda import MOST_TURNS, Agenda, LockstepError, Turn
from robots_core.ros.lockstep.phases import NANOSECONDS, NEVER, START, Phase
from robots_core.ros.lockstep.protocol import OVER, Announcement, Endpoint, Roster, as_json, decode, encode
from robots_core.ros.lockstep.timed_work import LockstepLoop, LockstepTimer, instant
from robots_core.ros.lockstep.traffic import CLOSED, Traffic

PERIOD = 4_000_000


def due(**phases: int) -> tuple[int, ...]:
    return tuple(phases.get(phase.name.lower(), NEVER) for phase in Phase)


def test_an_instant_goes_through_its_phases_in_order_and_skips_those_without_work():
    agenda = Agenda()
    agenda.set_due('drives', due(drives=START))
    agenda.set_due('controller', due(control=START, observe=START + PERIOD))
    assert agenda.next_turn() == Turn(START, Phase.CONTROL, ('controller',))
    agenda.set_due('controller', due(control=START + PERIOD, observe=START + PERIOD))
    assert agenda.next_turn() == Turn(START, Phase.DRIVES, ('drives',))
    agenda.set_due('drives', due(drives=START + PERIOD))
    assert agenda.next_turn() == Turn(START + PERIOD, Phase.CONTROL, ('controller',))


def test_a_program_that_was_woken_at_the_same_instant_has_another_turn():
    agenda = Agenda()
    agenda.set_due('program', due(program=START))
    agenda.set_due('controller', due(control=START + PERIOD))
    program = Turn(START, Phase.PROGRAM, ('program',))
    assert agenda.next_turn() == program
    assert agenda.next_turn() == program
    agenda.set_due('program', due(program=START + 1))
    assert agenda.next_turn() == Turn(START + 1, Phase.PROGRAM, ('program',))


@pytest.mark.parametrize('later', [START, START + 1])
def test_what_becomes_due_in_a_phase_that_is_over_is_done_at_its_own_time_or_waits_for_the_next_instant(
    later: int,
):
    agenda = Agenda()
    agenda.set_due('program', due(program=START))
    agenda.next_turn()
    agenda.set_due('program', due(program=START + PERIOD))
    agenda.set_due('controller', due(control=START))
    assert agenda.next_turn(advance=False) is None
    assert agenda.next_turn() == Turn(START, OVER, ('controller',))
    agenda.set_due('controller', due(control=later))
    time = START + PERIOD if later == START else later
    assert agenda.next_turn() == Turn(time, Phase.CONTROL, ('controller',))


def test_a_loop_that_is_needed_in_a_phase_that_is_over_has_its_turn_at_the_next_multiple():
    times: list[float] = []
    loop = LockstepLoop(
        times.append, period=PERIOD, phase=Phase.GUIDANCE, first=START, next_time=lambda: START / NANOSECONDS
    )
    assert loop.due == START
    loop.pass_over(START)
    assert loop.due == START + PERIOD
    loop.run(loop.due)
    assert times == [(START + PERIOD) / NANOSECONDS]
    assert loop.due == START + 2 * PERIOD


def test_time_stands_still_while_it_may_not_advance():
    agenda = Agenda()
    agenda.set_due('controller', due(control=START + PERIOD))
    assert agenda.next_turn(advance=False) is None
    assert agenda.time == START
    agenda.set_due('controller', due())
    assert agenda.next_turn() is None


def test_turns_without_end_at_one_instant_are_an_error():
    agenda = Agenda()
    agenda.set_due('program', due(program=START))
    for _ in range(MOST_TURNS):
        agenda.next_turn()
    with pytest.raises(LockstepError, match='program asked for'):
        agenda.next_turn()


def traffic(**participants: tuple[Endpoint, ...]) -> Traffic:
    made = Traffic()
    for name, endpoints in participants.items():
        made.join(name, endpoints)
    return made


def test_traffic_is_quiet_when_every_subscription_has_what_all_publishers_sent():
    topic = Endpoint('publisher', '/x')
    made = traffic(a=(topic,), b=(topic,), c=(Endpoint('subscription', '/x'),))
    made.count('a', 0, 2)
    made.count('b', 0, 1)
    assert made.on_the_way() == ['c has received 0 of 3 messages on /x']
    made.count('c', 0, 2)
    assert not made.quiet
    made.count('c', 0, 5)  # others publish too, who do not take part
    assert made.quiet


def test_a_latched_subscription_waits_for_latched_publishers_alone():
    made = traffic(
        a=(Endpoint('publisher', '/x'), Endpoint('publisher', '/x', latched=True)),
        b=(Endpoint('subscription', '/x', latched=True),),
    )
    made.count('a', 0, 7)
    assert made.quiet
    made.count('a', 1, 1)
    assert not made.quiet


def test_a_closed_subscription_is_not_waited_for():
    made = traffic(a=(Endpoint('publisher', '/x'),), b=(Endpoint('subscription', '/x'),))
    made.count('a', 0, 1)
    made.count('b', 0, CLOSED)
    assert made.quiet
    made.count('a', 0, 2)
    assert made.quiet


def test_a_request_is_under_way_until_its_reply_is_handled():
    client = (Endpoint('requests', '/s'), Endpoint('replies', '/s'))
    made = traffic(client=client, server=(Endpoint('service', '/s'),))
    made.count('client', 0, 1)
    made.count('server', 0, 1)
    assert made.on_the_way() == ['client has received 0 of 1 messages on /s']
    made.count('client', 1, 1)
    assert made.quiet
    alone = traffic(client=client)
    alone.count('client', 0, 1)  # to a server that does not take part
    assert alone.quiet


def test_a_polled_topic_holds_nothing_up_and_has_one_publisher():
    publisher = Endpoint('publisher', '/x')
    made = traffic(a=(publisher,), b=(Endpoint('polled', '/x'),))
    made.count('a', 0, 3)
    made.count('b', 0, 0)
    assert made.quiet
    assert made.sent('/x') == 3
    assert list(made.polled) == ['/x']
    with pytest.raises(InvalidInputError, match='published by a and by c'):
        made.join('c', (publisher,))


def test_messages_of_the_protocol_survive_their_transport():
    numbers = [0, -1, NEVER, START]
    assert decode(encode(numbers)) == tuple(numbers)
    endpoints = (Endpoint('publisher', '/x', latched=True), Endpoint('service', '/s'))
    announcement = Announcement('/a', endpoints, 3)
    assert Announcement.from_json(as_json(announcement)) == announcement
    roster = Roster(2, {'/a': endpoints}, ('/x',))
    assert Roster.from_json(as_json(roster)) == roster


def test_a_schedule_returns_every_multiple_once_and_in_order():
    schedule = PeriodicSchedule(10)
    assert schedule.due(25) == []
    assert schedule.due(30) == [30]
    assert schedule.due(30) == []
    assert schedule.due(59) == [40, 50]


def test_a_schedule_starts_again_after_a_jump():
    schedule = PeriodicSchedule(10, most_late=MAX_LATE_PERIODS)
    assert schedule.due(10) == [10]
    late = (MAX_LATE_PERIODS + 2) * 10
    assert schedule.due(10 + late) == [10 + late]
    assert schedule.missed == MAX_LATE_PERIODS + 1
    assert schedule.due(41) == []  # set back
    assert schedule.due(50) == [50]


def test_a_schedule_on_a_clock_that_is_set_in_steps_returns_all_multiples():
    schedule = PeriodicSchedule(10)
    assert schedule.due(10) == [10]
    assert schedule.due(200) == list(range(20, 201, 10))
    assert schedule.missed == 0


def test_a_loop_has_its_first_turn_at_the_start_and_ends_in_its_own_work():
    times: list[float] = []

    def work(now: float) -> None:
        times.append(now)
        if len(times) == 2:
            loop.stop()

    loop = LockstepLoop(work, period=PERIOD, phase=Phase.CONTROL, first=START)
    assert loop.due == START
    loop.run(START)
    assert loop.due == START + PERIOD
    loop.run(START + PERIOD)
    assert times == [1.0, 1.004]
    assert not loop.alive
    assert loop.due == NEVER


def test_a_loop_that_has_nothing_to_do_has_turns_only_at_the_multiples_at_which_it_has():
    times: list[float] = []
    needed = math.inf
    loop = LockstepLoop(
        times.append, period=PERIOD, phase=Phase.OBSERVE, first=START, next_time=lambda: needed
    )
    assert loop.due == NEVER
    needed = 1.0095
    assert loop.due == START + 3 * PERIOD
    loop.run(START + 3 * PERIOD)
    assert loop.due == START + 4 * PERIOD
    needed = math.inf
    assert loop.due == NEVER
    # Something was received at an instant between two multiples, or after the phase of that of a multiple.
    needed = 0.0
    assert loop.due <= START + 7 * PERIOD
    loop.run(START + 7 * PERIOD + 1)
    assert loop.due == START + 8 * PERIOD
    loop.run(START + 8 * PERIOD)
    assert times == [1.012, 1.032]
    assert loop.missed == 0


def test_a_timer_counts_from_its_reset():
    calls: list[int] = []
    timer = LockstepTimer(
        100, lambda: calls.append(1), phase=Phase.OBSERVE, now=lambda: 1000, autostart=False
    )
    assert timer.is_canceled()
    timer.reset()
    assert timer.due == 1100
    timer.run(1100)
    assert timer.due == 1200
    timer.timer_period_ns = 5
    timer.reset()
    assert timer.due == 1005
    assert calls == [1]


@pytest.mark.parametrize('time', [1.0, 1.004, 1.1, 123456.789012345, 0.3])
def test_an_instant_is_the_first_whose_seconds_are_not_before_the_time(time: float):
    nanoseconds = instant(time)
    assert (nanoseconds - 1) / 1e9 < time <= nanoseconds / 1e9


def test_an_infinite_time_is_never():
    assert instant(float('inf')) == NEVER

"""Nodes that share a process go through a lock-step run by themselves, as those of several processes do."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from robots_core.ros.lockstep import agenda
from robots_core.ros.lockstep.agenda import LockstepError
from robots_core.ros.lockstep.lead import Lead
from robots_core.ros.lockstep.phases import START, Phase
from robots_core.ros.qos import COMMAND
from robots_core.ros.running.lean_executor import LeanExecutor
from robots_core.ros.timed_node import TimedNode

PERIOD = 4_000_000  # ns


class Pair:
    """Two participants that share a process, spun as `run_nodes` does, and what they do in each period."""

    def __init__(self, runner: Any) -> None:
        self.runner = runner
        self.asker, self.server = (
            TimedNode(name, **runner.options(lockstep=True)) for name in ('asker', 'server')
        )
        self.handled: list[tuple[float, float]] = []  # times of sending and of handling, s
        self.replied: list[tuple[float, float]] = []
        self.work: Callable[[float], object] = lambda _: None
        self._numbers = self.asker.create_publisher(Float64, 'number', COMMAND)
        self._client = self.asker.create_client(Trigger, 'ask')
        self.server.create_subscription(Float64, 'number', self._on_number, COMMAND)
        self.server.create_service(Trigger, 'ask', lambda _, response: response)
        self.asker.start_loop(self._ask, period=PERIOD / START, name='asker')
        self.times: list[int] = []
        self.server.start_loop(
            lambda _: self.times.append(self.part.time), period=PERIOD / START, name='server'
        )

    @property
    def part(self) -> Any:
        return self.server.participant

    def _on_number(self, message: Float64) -> None:
        self.handled.append((message.data, self.server.now()))

    def _ask(self, now: float) -> None:
        self._numbers.publish(Float64(data=now))
        reply = self._client.call_async(Trigger.Request())
        reply.add_done_callback(lambda _: self.replied.append((now, self.asker.now())))
        self.work(now)

    @contextmanager
    def spun(self) -> Iterator[None]:
        """In a thread."""
        executor = LeanExecutor(context=self.runner.context)
        nodes = (self.asker, self.server)
        for node in nodes:
            executor.add_node(node)
        lead = Lead([node.participant for node in nodes if node.participant])
        end = threading.Event()

        def spin() -> None:
            while not end.is_set():
                executor.spin_once(0.02)
                lead.go_on()

        thread = threading.Thread(target=spin)
        thread.start()
        try:
            yield
        finally:
            end.set()
            thread.join()
            executor.shutdown()
            for node in nodes:
                node.destroy_node()


class SlowRecorder:
    """A recorder to which messages come as late as a test requests."""

    def __init__(self) -> None:
        self.late = ''
        self.asked = 0
        self.sent: dict[str, int] = {}

    def get_fully_qualified_name(self) -> str:
        return '/recorder'

    def recorded(self, topics: Iterable[str]) -> frozenset[str]:
        del topics
        return frozenset()

    def expect_instants(self, count: int, last: int) -> None:
        assert last == START + (count - 1) * PERIOD

    def missing(self, sent: Mapping[str, int]) -> str:
        self.asked += 1
        self.sent = dict(sent)
        return self.late


@pytest.fixture
def pair(ros_nodes: Any) -> Iterator[Pair]:
    pair = Pair(ros_nodes)
    with pair.spun():
        yield pair


def test_they_need_no_turn_of_the_coordinator_and_handle_everything_at_its_instant(pair: Pair) -> None:
    held = threading.Event()
    run = pair.runner.coordinate('asker', 'server', on_held=held.set)
    pair.runner.wait_for(lambda: len(pair.times) > 200, what='periods')
    pair.runner.call(run.hold)
    pair.runner.wait_for(held.is_set, what='the hold')
    assert run.instants <= 2
    assert pair.times == [START + k * PERIOD for k in range(len(pair.times))]
    assert len(pair.handled) == len(pair.replied) == len(pair.times)
    assert all(sent == handled for sent, handled in [*pair.handled, *pair.replied])


def test_a_held_run_stands_and_goes_on_where_it_was(pair: Pair) -> None:
    held = threading.Event()
    run = pair.runner.coordinate('asker', 'server', held=True, on_held=held.set)
    for _ in range(3):
        pair.runner.wait_for(held.is_set, what='the hold')
        count = len(pair.times)
        assert run.time == pair.times[-1] == START + (count - 1) * PERIOD
        held.clear()
        pair.runner.call(run.release)
        pair.runner.wait_for(lambda count=count: len(pair.times) >= count + 30, what='periods')
        pair.runner.call(run.hold)
    pair.runner.wait_for(held.is_set, what='the last hold')
    assert pair.times == [START + k * PERIOD for k in range(len(pair.times))]


def test_time_stands_until_the_recorder_has_what_was_sent_before(pair: Pair) -> None:
    recorder = SlowRecorder()
    run = pair.runner.coordinate('asker', 'server', recorder=recorder)

    def wait_for_checks() -> None:
        before = recorder.asked
        pair.runner.wait_for(lambda: recorder.asked > before + 2, what='checks of the recorder')

    for _ in range(2):
        count = len(pair.times)
        pair.runner.wait_for(lambda count=count: len(pair.times) > count + 50, what='periods')
        recorder.late = '3 of 4 messages on /number have come'
        wait_for_checks()
        count = len(pair.times)
        wait_for_checks()
        assert len(pair.times) == count
        assert 0 < recorder.sent['/clock'] <= count
        assert 'the recorder: 3 of 4 messages on /number have come at ' in run._not_done()
        recorder.late = ''
    pair.runner.call(run.end)


def test_a_participant_of_another_process_is_waited_for(pair: Pair) -> None:
    other = TimedNode('other', **pair.runner.options(lockstep=True))
    times: list[float] = []
    other.start_loop(times.append, period=PERIOD / START, name='other')
    pair.runner.add(other)
    run = pair.runner.coordinate('asker', 'server', 'other')
    pair.runner.wait_for(lambda: len(pair.times) > 50 and len(times) > 50, what='periods')
    pair.runner.call(run.end)
    assert run.instants > 50
    assert all(sent == handled for sent, handled in [*pair.handled, *pair.replied])


def test_work_in_a_thread_holds_time_for_as_long_as_it_takes(pair: Pair) -> None:
    begun, done = threading.Event(), threading.Event()

    def hold() -> None:
        with pair.part.busy():
            begun.set()
            done.wait()

    def work(now: float) -> None:
        if now > 1.1 and not begun.is_set():
            threading.Thread(target=hold).start()
            begun.wait()

    pair.work = work
    run = pair.runner.coordinate('asker', 'server')
    pair.runner.wait_for(begun.is_set, what='the work')
    # Nothing goes on: the coordinator has the lead again.
    pair.runner.wait_for(lambda: run.time == pair.times[-1], what='the lead')
    done.set()
    pair.runner.wait_for(lambda: pair.times[-1] > run.time + 20 * PERIOD, what='further periods')
    pair.runner.call(run.end)


def test_what_holds_time_for_ever_is_named(pair: Pair) -> None:
    with ExitStack() as work:
        pair.work = lambda now: now > 1.1 and work.enter_context(pair.asker.participant.busy())  # type: ignore[union-attr]
        run = pair.runner.coordinate('asker', 'server')
        reason = '/asker did not end the work under way at 1.104'
        pair.runner.wait_for(lambda: run._not_done().startswith(reason), what=reason)
        pair.runner.call(run.end)


def test_a_participant_that_lets_no_time_pass_is_named(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agenda, 'MOST_TURNS', 500)
    errors: list[LockstepError] = []

    def again(now: float) -> None:
        turn.ask(now)

    turn = pair.part.create_turn(again, phase=Phase.PROGRAM)
    pair.work = lambda now: now > 1.1 and again(now)
    run = pair.runner.coordinate('asker', 'server', on_error=errors.append)
    pair.runner.wait_for(lambda: errors, what='an error')
    assert '/server asked for 500 turns at 1.104' in str(errors[0])
    assert run.time == START + 26 * PERIOD


def test_the_coordinator_hears_of_a_run_that_goes_on(pair: Pair) -> None:
    pair.work = lambda _: threading.Event().wait(0.01)  # periods that take no processor time
    run = pair.runner.coordinate('asker', 'server')
    pair.runner.wait_for(lambda: len(pair.times) > 10, what='periods')
    for _ in range(2):
        before = run._progress
        pair.runner.wait_for(lambda before=before: run._progress > before, what='a sign of life')
    assert run.instants <= 2
    pair.runner.call(run.end)

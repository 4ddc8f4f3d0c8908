"""What a thread that keeps time asks of the system."""

from __future__ import annotations

import os
import struct
import threading
from pathlib import Path

import numpy as np
import pytest

from robots_core.periodic import periodic_thread, realtime
from robots_core.periodic.periodic_schedule import MAX_LATE_PERIODS
from robots_core.periodic.periodic_thread import PeriodicThread
from robots_core.periodic.realtime import processor_share, processor_share_in_silence

# s; far more than a thread takes to start.
PATIENCE = 20.0


def open_files() -> list[str]:
    links = Path('/proc/self/fd').iterdir()
    return [str(link.readlink()) for link in links if link.is_symlink()]


@pytest.fixture
def device(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file in the place of the system's, which only root may write to."""
    path = tmp_path / 'latency'
    path.touch()
    monkeypatch.setattr(realtime, 'IDLE_LATENCY_DEVICE', path)
    return path


@pytest.mark.parametrize(('latency', 'microseconds'), [(0.0, 0), (2e-6, 2), (1e-3, 1000)])
def test_a_latency_is_asked_for_in_microseconds_for_as_long_as_wanted(
    device: Path, latency: float, microseconds: int
):
    with realtime.idle_latency(latency) as granted:
        assert granted
        assert device.read_bytes() == struct.pack('i', microseconds)
        assert str(device) in open_files()  # the system drops the request when the file is closed
    assert str(device) not in open_files()


def test_nothing_is_asked_for_unless_wanted(device: Path):
    with realtime.idle_latency(None) as granted:
        assert not granted
        assert not device.read_bytes()


def test_who_may_not_ask_goes_on(device: Path):
    device.unlink()
    device.mkdir()  # not to be written to, by root neither
    with realtime.idle_latency(0.0) as granted:
        assert not granted


def test_a_thread_asks_while_it_runs(device: Path):
    called = threading.Event()

    def fail(error: BaseException) -> None:
        raise error

    thread = PeriodicThread(
        lambda _: called.set(), period=1e-3, name='keeps time', on_error=fail, idle_latency=0.0
    )
    thread.start()
    assert called.wait(PATIENCE)
    assert thread.idle_latency_kept
    assert str(device) in open_files()
    thread.stop()
    assert not thread.alive
    assert str(device) not in open_files()


@pytest.mark.parametrize(('minute', 'now'), [('0.50', '1/200'), ('8.00', '1/200'), ('0.10', '41/200')])
def test_processes_share_the_processors_that_there_are(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, minute: str, now: str
) -> None:
    load = tmp_path / 'loadavg'
    load.write_text(f'{minute} 0.00 0.00 {now} 4711\n')
    monkeypatch.setattr(realtime, 'LOAD', load)
    monkeypatch.setattr(realtime, 'PRESSURE', tmp_path / 'none')
    runnable = max(float(minute), int(now.partition('/')[0]) - 1)
    assert processor_share() == min(1.0, (os.cpu_count() or 1) / max(runnable, 1.0))


def test_load_counts_for_as_long_as_something_has_waited(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Clock:
        now = 100.0

        def monotonic(self) -> float:
            return self.now

    clock, load, pressure = Clock(), tmp_path / 'loadavg', tmp_path / 'cpu'
    load.write_text(f'{4 * (os.cpu_count() or 1)}.00 0.00 0.00 1/200 4711\n')
    for name, value in (
        ('time', clock),
        ('LOAD', load),
        ('PRESSURE', pressure),
        ('_stalls', realtime.Stalls()),
    ):
        monkeypatch.setattr(realtime, name, value)
    shares = []
    for after, total in (
        (0.0, 7_000),  # since when is unknown
        (0.04, 15_000),  # a fifth of the time
        (0.001, 15_500),  # too short to say
        (0.04, 58_000),  # all of it
        (1.0, 60_000),  # too long ago
    ):
        clock.now += after
        pressure.write_text(f'some avg10=9.00 avg60=9.00 avg300=9.00 total={total}\nfull total=0\n')
        shares.append(processor_share())
    pressure.write_text('')
    clock.now += 0.04
    assert [*shares, processor_share()] == pytest.approx([0.25, 0.85, 0.85, 0.25, 0.25, 0.25])


def test_after_a_silence_the_threads_of_the_process_itself_do_not_count(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    load, tasks = tmp_path / 'loadavg', tmp_path / 'task'
    load.write_text('0.50 0.00 0.00 21/200 4711\n')
    for number, state in enumerate('R' * 20 + 'S' * 5):
        (tasks / str(number)).mkdir(parents=True)
        (tasks / str(number) / 'stat').write_text(f'{number} (a (thread)) {state} 1 1')
    (tasks / 'ended').mkdir()
    monkeypatch.setattr(realtime, 'LOAD', load)
    monkeypatch.setattr(realtime, 'PRESSURE', tmp_path / 'none')
    monkeypatch.setattr(realtime, 'TASKS', tasks)
    assert processor_share_in_silence() == 1.0
    load.write_text('0.50 0.00 0.00 61/200 4711\n')
    assert processor_share_in_silence() == (os.cpu_count() or 1) / 41.0
    monkeypatch.setattr(realtime, 'TASKS', tmp_path / 'none')
    assert processor_share_in_silence() == processor_share()


def test_threads_that_can_run_for_a_moment_are_no_load_after_a_silence(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class Load:
        """Many threads can run at the first checks."""

        checks = 0

        def read_text(self) -> str:
            self.checks += 1
            return f'0.50 0.00 0.00 {41 if self.checks < 4 else 1}/200 4711\n'

    load = Load()
    monkeypatch.setattr(realtime, 'LOAD', load)
    monkeypatch.setattr(realtime, 'PRESSURE', tmp_path / 'none')
    monkeypatch.setattr(realtime, 'TASKS', tmp_path / 'none')
    assert processor_share_in_silence() == 1.0
    assert load.checks == 4


def test_a_loop_that_was_frozen_is_never_called_with_a_time_long_past(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Clock:
        """Each tenth sleep lasts much longer than it should."""

        now, sleeps = 0.0, 0

        def monotonic(self) -> float:
            return self.now

        def sleep(self, duration: float) -> None:
            self.sleeps += 1
            self.now += duration if self.sleeps % 10 else 0.7

    clock, calls = Clock(), []
    monkeypatch.setattr(periodic_thread, 'time', clock)

    def work(deadline: float) -> None:
        calls.append(deadline)
        assert clock.now - deadline <= MAX_LATE_PERIODS * thread.period
        if len(calls) == 50:
            thread.stop()

    failed: list[BaseException] = []
    thread = PeriodicThread(work, period=0.04, name='keeps time', on_error=failed.append)
    thread.start()
    thread._thread.join()
    assert failed == []
    assert thread.missed == 5 * int((0.7 - 0.04) / 0.04)
    assert np.diff(calls).min() == pytest.approx(0.04)


def test_a_loop_leaves_out_periods_until_something_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    class Clock:
        now = 100.0

        def monotonic(self) -> float:
            return self.now

        def sleep(self, duration: float) -> None:
            self.now += duration

    class Resting:
        """After each call, so many periods have nothing to do, and something comes after a time."""

        def __init__(self) -> None:
            self.plan = [(0, None), (4, None), (4, 0.25), (4, 0.0), (3, 0.149), (0, None)]
            self.passed: list[int] = []

        def periods(self) -> int:
            most, self.comes = self.plan.pop(0)
            return most

        def wait(self, timeout: float) -> bool:
            clock.now += timeout if self.comes is None else self.comes
            return self.comes is not None

        def left_out(self, periods: int) -> None:
            self.passed.append(periods)

    clock, rest, calls = Clock(), Resting(), []
    monkeypatch.setattr(periodic_thread, 'time', clock)

    def work(deadline: float) -> None:
        calls.append(deadline)
        assert clock.now == pytest.approx(deadline)
        if len(calls) == 6:
            thread.stop()

    failed: list[BaseException] = []
    thread = PeriodicThread(work, period=0.1, name='rests', on_error=failed.append, rest=rest)
    thread.start()
    thread._thread.join()
    assert failed == []
    assert thread.missed == 0
    assert rest.passed == [4, 2, 0, 1]
    np.testing.assert_allclose(np.diff(calls), [0.1, 0.5, 0.3, 0.1, 0.2])


def test_without_figures_each_process_has_a_processor(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(realtime, 'LOAD', tmp_path / 'none')
    assert processor_share() == 1.0

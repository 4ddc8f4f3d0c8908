"""Trial: one node killed or frozen at a random moment, and a person who lets the robot continue."""

import contextlib
import os
import random
import signal
import time
from dataclasses import dataclass
from typing import Final

import numpy as np

from waiting import happens

from .judgement import OBSERVED
from .observer import Observer
from .recording import Recording
from .surroundings import Surroundings

READY_TIME: Final = 600.0  # s until a fresh cell runs its program
USABLE_TIME: Final = 60.0  # s until a person gives up
LONGEST_DELAY: Final = 5.0  # s from when the robot moves to the fault
FROZEN: Final = (
    0.6,
    1.8,
)  # s that a node is frozen which continues to run: missed, and not yet killed by `cell`
MOVES_ON: Final = 0.5  # s in which a program that continues moves the robot, except for short waits
HELD: Final = 0b100  # bit of the PLC's word that keeps its value


class NotReadyError(Exception):
    """The cell does not run its program: trials in it make no sense."""


@dataclass(frozen=True)
class Trial:
    """What is done to which node.

    Attributes:
        number: Of the trial; its random moment follows from it and the seed.
        node: The node.
        killed: Killed at once; otherwise frozen.
        revived: A frozen node continues to run later; otherwise it is killed later.
        delay: s from when the robot moves to the fault.
        frozen: s that it is frozen if it continues to run.
    """

    number: int
    node: str
    killed: bool
    revived: bool
    delay: float
    frozen: float


def random_trial(seed: int, number: int, node: str, *, killed: bool) -> Trial:
    """The trial of a number; always the same for a seed."""
    rng = random.Random(f'{seed} {number} {node}')  # noqa: S311  # no secret
    delay, frozen = rng.uniform(0.0, LONGEST_DELAY), rng.uniform(*FROZEN)
    return Trial(number, node, killed, not killed and rng.random() < 0.5, delay, frozen)


def run_trial(trial: Trial, cell: Surroundings, observer: Observer) -> Recording:
    """Do it, and return what was seen.

    Raises:
        NotReadyError: the program does not run before, or the node has no process.
    """
    until_running(observer)
    cell.wait_until_killable(trial.node)
    time.sleep(trial.delay)
    pid = cell.pid(trial.node)
    if pid is None:
        raise NotReadyError(f'{trial.node} has no process')
    observer.forget()
    time.sleep(0.2)  # how the robot moved before
    held = observer.words(0.0)[-1:]
    safe = held[0][1] & HELD if held else 0
    os.kill(pid, signal.SIGKILL if trial.killed else signal.SIGSTOP)
    origin = time.time()
    if trial.revived:
        time.sleep(trial.frozen)
        os.kill(pid, signal.SIGCONT)
        resumed = time.time() - origin
    time.sleep(max(0.0, origin + OBSERVED - time.time()))
    if not trial.revived:
        with contextlib.suppress(ProcessLookupError):  # `cell` has killed a frozen one
            os.kill(pid, signal.SIGKILL)
        cell.bring_back(trial.node)
        resumed = time.time() - origin
    running = goes_on(observer)
    commanded = moved = np.inf
    if not running:
        commanded = time.time() - origin
        moved = let_go_on(observer, origin)
    latched, reason = observer.stop(origin)
    return Recording(
        node=trial.node,
        killed=trial.killed,
        references=observer.references(origin),
        feedback=observer.feedback(origin),
        path=observer.path(),
        latched=latched,
        reason=reason,
        drives=observer.drives(origin),
        words=observer.words(origin),
        safe=safe,
        resumed=resumed,
        commanded=commanded,
        moved=moved,
        running=running,
    )


def until_running(observer: Observer) -> None:
    """Wait until all nodes are there and the program moves the robot; one that has failed is run again.

    A node that was killed is back before the next fault: each fault is a single one.

    Raises:
        NotReadyError: it does not, with what the cell says.
    """
    deadline = time.monotonic() + READY_TIME
    while not happens(
        lambda: observer.all_alive and observer.program_state == 'RUNNING' and observer.moving, 2.0
    ):
        state, error = observer.program_state, observer.program_error
        if time.monotonic() > deadline:
            raise NotReadyError(
                f'the program does not move the robot within {READY_TIME:g} s: it is '
                f'{state or "unknown"} {error}'
            )
        if state in {'FAILED', 'STOPPED'}:
            print(f'between two faults: {error}', flush=True)
            let_go_on(observer, 0.0)


def goes_on(observer: Observer) -> bool:
    """The program runs, and moves the robot, as if nothing had happened."""
    return observer.program_state == 'RUNNING' and happens(
        lambda: observer.program_state == 'RUNNING' and observer.moving, MOVES_ON
    )


def let_go_on(observer: Observer, origin: float) -> float:
    """Reset, open and run, as a person does, until the robot moves: when it did, s after the origin."""
    deadline, obstacle = time.monotonic() + USABLE_TIME, 'not all nodes give signs of life'
    # A person sees on the pendant which nodes are lost. Before, a call would go to the dead process.
    happens(lambda: observer.all_alive, USABLE_TIME)
    while time.monotonic() < deadline:
        # What is not necessary is refused, and does no harm.
        observer.call('lua_program_node/stop')
        for service in ('controller_node/reset', 'lua_program_node/open', 'lua_program_node/run'):
            succeeded, text = observer.call(service)
            if not succeeded:
                obstacle = f'{service}: {text}'
                break
        else:
            if happens(lambda: observer.program_state in {'RUNNING', 'FAILED'} and observer.moving, 2.0):
                return time.time() - origin
            obstacle = f'the program is {observer.program_state} {observer.program_error}'
        time.sleep(0.2)
    print(f'not usable within {USABLE_TIME:g} s: {obstacle}', flush=True)
    return np.inf

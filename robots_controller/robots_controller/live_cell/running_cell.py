"""RunningCell: waits for the nodes of a cell, runs its program, and watches the processes."""

import argparse
import math
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path

from rich.markup import escape

from robots_controller.io.cell_io import read_cell_io
from robots_controller.live_cell.cell_events import (
    Event,
    MotionPlanned,
    NodeHealth,
    ProgramStatus,
)
from robots_controller.live_cell.cell_listener import CellListener
from robots_controller.live_cell.cell_view import CellView
from robots_controller.live_cell.processes.node_processes import NodeProcesses
from robots_controller.live_cell.processes.node_restarts import FrozenNodes, NodeRestarts
from robots_controller.recording.motion_record import MOTION_TOPICS
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import MODES, Commander, OperatingMode
from robots_core.exit_codes import ExitCode

LATE = 100  # motions whose results may overtake their plans
START_TIMEOUT = 600.0  # s, for all nodes to be ready on a slow machine
WAIT_REPORT = 10.0  # s between reports of what is waited for
SERVICE_TIMEOUT = 60.0  # s
SEARCH_TIME = 0.3  # s, for nodes of another cell to be found before the own ones are started
SETTLING_TIME = 2.0  # s after all are ready, in which another cell would have been noticed
REST_TIMEOUT = 5.0  # s, for the robot to stop on its path
POLL = 0.05  # s between checks of processes and events

# What a report needs; the recorder is subscribed to these before the program starts.
REPORTED_TOPICS = ('command_state', 'digital_outputs', 'joint_states')
CONTROLLED_TOPICS = (*REPORTED_TOPICS, *MOTION_TOPICS, 'joint_reference')
"""The same where controller_node moves the robot."""


class RunningMotion:
    """Follows plans and results. A result that overtakes its plan ends the motion too."""

    def __init__(self) -> None:
        self._id: str | None = None
        self._ended: deque[str] = deque(maxlen=LATE)
        # Results of streams have the id of their first point, and may overtake their last ones.
        self._streaming, self._stream_end = False, 0.0

    @property
    def runs(self) -> bool:
        """A motion was planned, and has not ended."""
        return self._id is not None

    def note(self, event: MotionPlanned | MotionResult) -> None:
        """Take the next event."""
        if isinstance(event, MotionPlanned):
            late = float(event.id) <= self._stream_end if event.streamed else event.id in self._ended
            if not late:
                self._id, self._streaming = event.id, event.streamed
        elif not event.blocked:  # otherwise the planner leads the robot around the obstacle
            self._ended.append(event.id)
            if event.id == self._id or self._streaming:
                self._id, self._stream_end = None, float(event.details.get('ended', 0.0))


class RunningCell:
    """A running cell: waits for its nodes, runs the program, watches the processes."""

    def __init__(
        self,
        options: argparse.Namespace,
        processes: NodeProcesses,
        listener: CellListener,
        view: CellView,
    ) -> None:
        self._options, self._processes, self._listener = options, processes, listener
        self._monitor, self._recorder = listener.monitor, listener.recorder
        self._view, self._console = view, view.console
        self._restarts = NodeRestarts(
            processes,
            self._monitor,
            self._console,
            fail_safe=read_cell_io(options.io, options.io_map).fail_safe,
            # A lock-step run ends with a participant that is lost.
            restarting=not (options.once or options.no_restart or options.lockstep),
        )
        watchdog = 0.0 if options.lockstep else options.watchdog
        self._frozen = FrozenNodes(self._monitor, processes.names, watchdog)
        self._waiting = set(processes.names)
        self._failed = False
        self._motion = RunningMotion()
        self._ended = False
        self._settled = math.inf
        self._recording_ended = False
        self._starting = True
        self._reported = time.monotonic()
        self._foreign = ''
        """A node of this cell that runs in another process too."""
        self.program_ended = False

    def others(self) -> str:
        """A node of this cell's names that is there before any is started; '' for none."""
        deadline = time.monotonic() + SEARCH_TIME
        while time.monotonic() < deadline:
            if found := self._monitor.present(self._processes.names):
                return found[0]
            time.sleep(POLL)
        return ''

    def run(self) -> int:
        """Until the program has ended, a node dies, or forever."""
        if not self._until(self._ready, START_TIMEOUT):
            if not self._ended:
                self._console.print(f'[bold red]not ready after {START_TIMEOUT:g} s:[/] {self._late}')
            return ExitCode.FAILED
        self._settled, self._starting = time.monotonic() + SETTLING_TIME, False
        self._console.print('the cell is ready')
        if self._options.program and not self._start_program():
            return ExitCode.FAILED
        self._listener.release()
        while self._healthy():
            self._show_events()
            # What was sent before a program fails continues to its end, and its outputs with it.
            if self.program_ended and self._options.once and not self._motion.runs:
                return ExitCode.FAILED if self._failed else ExitCode.OK
        return ExitCode.FAILED

    def _start_program(self) -> bool:
        """Run the program, or open it where a person runs it; False if it is refused."""
        options, mode = self._options, OperatingMode(self._options.operating_mode)
        by_itself = Commander.PROGRAM in MODES[mode].commanders and not MODES[mode].held
        if by_itself or options.once or options.lockstep:
            return self._call('open') and self._call('run')
        name = Path(options.program).name
        self._console.print(
            f'{name} is open; in operating mode {mode} lua_program_node/run starts it while run is held'
            if MODES[mode].held
            else f'{name} is open; in operating mode {mode} no program runs'
        )
        return self._call('open')

    def watch(self) -> None:
        """Until a node dies, or forever."""
        while self._healthy():
            self._show_events()

    def bring_to_rest(self) -> None:
        """Stop a running motion on its path, before the nodes end."""
        if not self._motion.runs or not self._processes.runs('controller_node'):
            return
        self._monitor.triggers.call('controller_node/cancel')
        deadline = time.monotonic() + REST_TIMEOUT
        while self._motion.runs and time.monotonic() < deadline:
            self._show_events()

    def _ready(self) -> bool:
        # Health changes with time, which stands still at the first instant of a lock-step run.
        ready = self._listener.held if self._options.lockstep else not self._waiting
        topics = CONTROLLED_TOPICS if 'controller_node' in self._processes.names else REPORTED_TOPICS
        if ready and (self._recorder is None or self._recorder.records(topics)):
            return True
        if time.monotonic() - self._reported >= WAIT_REPORT:
            self._reported = time.monotonic()
            self._console.print(f'waiting for {self._late}')
        return False

    @property
    def _late(self) -> str:
        return ', '.join(sorted(self._waiting)) or 'the recorder'

    def _until(self, condition: Callable[[], bool], timeout: float) -> bool:
        deadline = time.monotonic() + timeout
        while not condition():
            if not self._healthy() or time.monotonic() > deadline:
                return False
            self._show_events()
        return True

    def _healthy(self) -> bool:
        """All nodes live, and this cell is alone in its place; otherwise says why not, once."""
        if self._ended:
            return False
        for name in self._frozen.check(time.monotonic()):
            self._console.print(
                f'[bold red]{name} gives no sign of life for {self._frozen.timeout:g} s[/]: it is killed'
            )
            self._processes.kill(name)
        for process in self._processes.take_dead():
            self._console.print(f'[bold red]{process.name} {process.reason}[/]\n{escape(process.last_lines)}')
            if not self._restarts.died(process) or self._starting:
                self._ended = True
        for name in self._restarts.start_due():
            self._frozen.started(name)
            self._view.expect(name)
        if self._listener.problem:
            self._console.print(f'[bold red]{escape(self._listener.problem)}[/]')
            self._ended = True
        self._show_recording()
        # The established cell keeps the namespace; the newcomer exits.
        if self._foreign and time.monotonic() < self._settled:
            self._console.print(occupied(self._foreign, self._options.namespace))
            self._ended = True
        return not self._ended

    def _show_recording(self) -> None:
        """Show why the recording is not complete, once."""
        if self._recorder is not None and self._recorder.problem and not self._recording_ended:
            self._recording_ended = True
            self._console.print(f'[bold red]recording: {escape(self._recorder.problem)}[/]')

    def close_recording(self, *, judged: bool) -> int:
        """Close the bag, if there is one that is open, and report on a program that is `judged`.

        Returns:
            An exit code.
        """
        recorder, options = self._recorder, self._options
        if recorder is None or recorder.closed:
            return ExitCode.OK
        self._listener.close_recording()
        self._show_recording()
        if options.record:
            self._console.print(f'bag: {recorder.path}')
        if recorder.problem:
            return ExitCode.FAILED
        if not judged:
            return ExitCode.OK
        # Loads SciPy and the reading of meshes, which the cell itself does not need.
        from robots_controller.commands.json_output import print_json  # noqa: PLC0415
        from robots_controller.report.report_json import report_data  # noqa: PLC0415
        from robots_controller.report.run_report import run_report  # noqa: PLC0415
        from robots_controller.report.terminal import show_verdict  # noqa: PLC0415

        report = run_report(recorder.path, robot=options.robot, namespace=options.namespace)
        if options.json:
            print_json(report_data(report))
        else:
            show_verdict(report, self._console)
        return ExitCode.OK if report.ok else ExitCode.FAILED

    def _call(self, service: str) -> bool:
        future = self._listener.call(f'lua_program_node/{service}')
        if not self._until(future.done, SERVICE_TIMEOUT):
            self._console.print(f'[bold red]lua_program_node does not answer ~/{service}[/]')
            return False
        response = future.result()
        if not response.success:
            self._console.print(f'[bold red]{response.message}[/]')
        return bool(response.success)

    def _show_events(self) -> None:
        """Show what came in since the last call."""
        for event in self._monitor.take():
            if isinstance(event, NodeHealth) and not self._processes.owns(event.node, event.pid):
                if event.node in self._processes.names:
                    self._foreign = event.node
                continue
            self._note(event)
            self._view.show(event)
        time.sleep(POLL)

    def _note(self, event: Event) -> None:
        match event:
            case NodeHealth(node=node) if event.ok or event.works:
                self._waiting.discard(node)
            case MotionPlanned() | MotionResult():
                self._motion.note(event)
            case ProgramStatus(state):
                self._restarts.program_reported(event)
                ended = state in ('FINISHED', 'FAILED', 'STOPPED')
                if ended and not self.program_ended and not self._options.once:
                    self._console.print(f'[bold]program {state.lower()}[/]')
                self.program_ended = ended
                self._failed = state in ('FAILED', 'STOPPED')


def occupied(found: str, namespace: str, detail: str = '') -> str:
    """Why a cell cannot run: something of another one was found in its namespace."""
    return (
        f'[bold red]there is another {found} in namespace {namespace}[/]{escape(detail)}: '
        f'another cell is running; stop it, or give this one a --namespace or a ROS_DOMAIN_ID'
    )

"""CellView: what happens in the cell, as lines for a person in a terminal."""

from __future__ import annotations

import time
from collections.abc import Sequence

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from robots_controller.degrees import in_degrees, joints_text
from robots_controller.live_cell.cell_events import (
    Event,
    MotionCommanded,
    MotionPlanned,
    MotionProgress,
    NodeHealth,
    OutputsChanged,
    ProgramPrint,
    ProgramStatus,
)
from robots_core.cell_interface.motion_result import PASSED, MotionResult
from robots_core.pose import Pose
from robots_core.validation import Array

MARGIN = ' ' * 8
REPEAT_TIME = 5.0  # s


class CellView:
    """Writes one line per thing that happens and a bar over the running motion."""

    def __init__(self, console: Console, nodes: Sequence[str], prismatic: tuple[bool, ...] = ()) -> None:
        self._prismatic = prismatic
        self.console = console
        self._waiting = list(nodes)
        self._place = ('', 0)  # file and line
        self._shown: dict[str, float] = {}
        self._commanded: dict[str, MotionCommanded] = {}  # by id, not planned yet, oldest first
        self._planned: dict[str, str] = {}  # kinds by id, not ended yet, oldest first
        self._running: str | None = None  # id of the motion that has the bar
        self._bar = Progress(
            TextColumn(f'{MARGIN}[cyan]{{task.description}}'),
            BarColumn(bar_width=40),
            TextColumn('{task.percentage:>3.0f} %'),
            TimeElapsedColumn(),
            console=console,
            transient=True,
        )
        self._task: TaskID | None = None

    def expect(self, node: str) -> None:
        """A node is started again."""
        self._waiting.append(node)

    def close(self) -> None:
        """Remove the bar."""
        if self._task is not None:
            self._bar.stop()

    def show(self, event: Event) -> None:
        """Show an event."""
        match event:
            case NodeHealth():
                self._show_health(event)
            case ProgramStatus():
                self._show_program(event)
            case ProgramPrint(text):
                self._print(f'{MARGIN}[bold]{escape(text)}[/]')
            case MotionCommanded(id_):
                self._commanded[id_] = event
            case MotionPlanned():
                self._show_planned(event)
            case MotionProgress(progress):
                if self._task is not None:
                    self._bar.update(self._task, completed=progress)
            case MotionResult():
                self._show_end(event)
            case OutputsChanged():
                self._show_outputs(event)

    def _print(self, text: str) -> None:
        self.console.print(text, highlight=False, soft_wrap=True)

    def _print_on_one_line(self, text: str) -> None:
        """A line of a file that a person can look up: a narrow terminal shows its beginning."""
        if self.console.is_terminal:
            self.console.print(text, highlight=False, soft_wrap=False, no_wrap=True, overflow='ellipsis')
        else:
            self._print(text)

    def _show_outputs(self, event: OutputsChanged) -> None:
        for index, value in event.changes:
            self._print(f'{MARGIN}{event.kind} output {index} [bold magenta]-> {value:g}[/]')

    def _show_health(self, event: NodeHealth) -> None:
        if (event.ok or event.works) and event.node in self._waiting:
            self._waiting.remove(event.node)
            where = f'  [link={event.url}]{event.url}[/link]' if event.url else ''
            self._print(f'  [green]ready[/]  {event.node}{where}')
        if not event.ok and event.node not in self._waiting and self._is_news(event):
            self._print(f'  [yellow]{event.node}: {escape(in_degrees(event.message))}[/]')

    def _is_news(self, event: NodeHealth) -> bool:
        """Not printed for this node within the last seconds: the same trouble often repeats."""
        now = time.monotonic()
        last = self._shown.get(event.node, -REPEAT_TIME)
        if now - last < REPEAT_TIME:
            return False
        self._shown[event.node] = now
        return True

    def _show_program(self, event: ProgramStatus) -> None:
        if event.error:
            self._print(f'[bold red]{escape(event.error)}[/]')
        elif event.state == 'RUNNING' and event.line and (event.file, event.line) != self._place:
            if self._place[0] not in ('', event.file):
                self._print(f'[dim]  in    {escape(event.file)}[/]')
            self._place = (event.file, event.line)
            self._print_on_one_line(f'[dim]{event.line:>5}[/]   {escape(event.source.strip())}')

    def _show_planned(self, event: MotionPlanned) -> None:
        if event.id not in self._commanded:  # a streamed reference
            return
        chain: list[MotionCommanded] = []
        while not chain or chain[-1].id != event.id:
            chain.append(self._commanded.pop(next(iter(self._commanded))))
        for motion in chain:
            last = f' in [bold]{event.duration:.2f} s[/]' if motion is chain[-1] else ', runs through'
            self._print(f'{MARGIN}[cyan]{motion.kind}[/] to {self._target(motion.target)}{last}')
        self._planned[event.id] = chain[-1].kind
        self._show_running()

    def _show_end(self, event: MotionResult) -> None:
        if event.blocked:
            self._print(f'{MARGIN}[yellow]{event.message}[/]')
            return
        self._commanded.pop(event.id, None)
        self._planned.pop(event.id, None)
        self._show_running()
        if event.message == PASSED:  # the end of its chain is reported
            return
        if event.ok:
            duration = float(event.details.get('duration', 'nan'))
            self._print(f'{MARGIN}[green]{event.message}[/] after {duration:.2f} s')
        else:
            self._print(f'{MARGIN}[yellow]stopped: {escape(in_degrees(event.message))}[/]')

    def _show_running(self) -> None:
        """A bar for the oldest motion that is planned and has not ended."""
        running = next(iter(self._planned), None)
        if running == self._running or not self.console.is_terminal:
            return
        if self._task is not None:
            self._bar.remove_task(self._task)
            self._bar.stop()
            self._task = None
        self._running = running
        if running is not None:
            self._bar.start()
            self._task = self._bar.add_task(self._planned[running], total=1.0)

    def _target(self, target: Pose | Array) -> str:
        """A target as a program has it."""
        if isinstance(target, Pose):
            x, y, z = target.r
            return f'({x:.3f}, {y:.3f}, {z:.3f}) m'
        return joints_text(target, self._prismatic)

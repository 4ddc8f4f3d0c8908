"""A cell that is made up: what the page shows of it is set, what is pressed is written down."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from robots_controller.interpreter.debugger import CallStack
from robots_controller.io.io_image import IMAGES, Channel
from robots_controller.pendant.message_log import Level
from robots_controller.pendant.motion_recording import MeasuredMotion
from robots_controller.pendant.page.access.page_server import PageServer
from robots_controller.pendant.page.pendant_page import PendantPage
from robots_controller.pendant.page_access import PageAccess
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import PendantState, ShownIo, ShownProgram
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.program.run_state import RunState
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import RobotsError
from robots_core.validation import Array

ROOT = Path(__file__).parents[2]
PROGRAMS = ROOT / 'programs'
LABELS = {
    'digital_inputs': ('press_ready', 'press_closed', 'part_present', 'part_pressed'),
    'digital_outputs': ('start_press', 'gripper', 'part_placed'),
    'analog_inputs': ('press_force',),
}
PATIENCE = 60.0  # s
SIZES = {'digital_inputs': 64, 'digital_outputs': 64, 'analog_inputs': 8, 'analog_outputs': 8}


@dataclass
class MadeUpCell:
    """See `PendantPort`."""

    calls: list[tuple[Any, ...]] = field(default_factory=list)
    refusal: str = ''
    stack: CallStack = field(default_factory=CallStack)
    done: Callable[[RobotsError | None], None] = print
    motion: list[MeasuredMotion] = field(default_factory=list)

    def jog_axes(self, velocity: Array) -> None:
        self.calls.append(('axes', *velocity.tolist()))

    def jog_tool(self, twist: Array, frame: str) -> None:
        self.calls.append((frame, *twist.tolist()))

    def hold_run(self, *, held: bool) -> None:
        self.calls.append(('hold', held))

    def begin_move(self, command: MotionCommand, done: Callable[[RobotsError | None], None]) -> None:
        self.calls.append(('move', command))
        self.done = done

    def end_move(self) -> None:
        self.calls.append(('end_move',))

    def reference(self) -> Array | None:
        return None

    def feedback(self) -> MeasuredMotion | None:
        return self.motion.pop(0) if self.motion else None

    def show_ghost(self, q: Array | None) -> None:
        self.calls.append(('ghost', q))

    def set_override(self, value: float) -> None:
        self.calls.append(('override', value))

    def stop(self) -> None:
        self.calls.append(('stop',))

    def call(self, service: str) -> str:
        self._answer(service)
        return json.dumps(asdict(self.stack))

    def open_program(self, path: str) -> None:
        self._answer('open', path)

    def set_parameters(self, node: str, **values: object) -> None:
        self._answer(node, values)

    def set_io(self, channel: Channel, value: float) -> None:
        self._answer('set', channel.name, value)

    def force(self, channel: Channel, value: float | None) -> None:
        self._answer('force', channel.name, value)

    def _answer(self, *call: Any) -> None:
        self.calls.append(call)
        if self.refusal:
            raise RobotsError(self.refusal)

    def moving(self) -> bool:
        """The last jog was none of zeros."""
        jogs = [call for call in self.calls if call[0] in ('axes', 'tool', 'base')]
        return bool(jogs) and any(jogs[-1][1:])


def ready_state(robot: BaseRobotModel, **changes: Any) -> PendantState:
    """A cell in which all works, in mode T1."""
    q = np.array(robot.home)
    values = {image: (0.0,) * size for image, size in SIZES.items()}
    state = PendantState(
        lost=(),
        mode=OperatingMode.T1,
        drives_on=True,
        q=q,
        tool=Pose(*robot.direct_kinematics(q)),
        io=ShownIo(values=values, labels=LABELS),
    )
    return replace(state, **changes)


def made_up_operator(robot: str = 'kuka_kr210_r2700') -> tuple[PendantOperator, MadeUpCell]:
    """An operator of a made-up cell that is ready."""
    cell = MadeUpCell()
    operator = PendantOperator(load_robot_model(robot), cell, time.monotonic)
    operator.state = ready_state(operator.robot)
    return operator, cell


@contextmanager
def served(
    operator: PendantOperator,
    folder: Path = PROGRAMS,
    access: PageAccess | None = None,
    connection_timeout: float = PATIENCE,
) -> Iterator[str]:
    """The page of an operator; gives its address. A browser that a busy machine holds up is not lost."""
    build = partial(PendantPage, operator, folder)
    server = PageServer(
        build,
        port=0,
        title=operator.robot.name,
        access=access,
        scene=lambda: operator.state.scene_url,
        connection_timeout=connection_timeout,
    )
    try:
        yield server.url
    finally:
        server.close()


def running_program(operator: PendantOperator, name: str = 'press_tending.lua', line: int = 12) -> None:
    """A program of the folder is at a line."""
    program = ShownProgram(str(PROGRAMS / name), RunState.RUNNING, name, line, name, line - 2)
    operator.state = replace(operator.state, program=program, commander=Commander.PROGRAM)


def switched(state: PendantState, image: str, index: int, value: float) -> PendantState:
    """The state with another value of a channel."""
    assert image in IMAGES
    values = list(state.io.values[image])
    values[index - 1] = value
    return replace(state, io=replace(state.io, values={**state.io.values, image: tuple(values)}))


def some_messages(operator: PendantOperator) -> None:
    """Messages of a morning."""
    log: Callable[..., None] = operator.messages.add
    start = 1_795_507_200.0
    log(
        start,
        Level.INFO,
        'planning_node',
        'PTP joint planned: 2.317 s, limited by 98 % of the velocity of A1',
        'press_tending.lua:12',
    )
    log(start + 4.0, Level.WARNING, 'controller_node', 'motion stopped: stopped by its client')
    for second in range(3):
        log(start + 9.0 + second, Level.WARNING, 'planning_node', 'jogging is limited by A3 position upper')
    log(
        start + 21.0,
        Level.ERROR,
        'lua_program_node',
        'press_tending.lua:14: press_ready did not come within 5 s',
    )

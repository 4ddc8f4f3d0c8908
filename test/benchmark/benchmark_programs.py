"""How fast robot programs are: motions, inputs that interrupt, services, and Lua statements next to bare Lua.

Run by `make benchmark-programs`. The sandboxed and the bare interpreter take turns, so that a busy machine
hits both.
"""

from __future__ import annotations

import argparse
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import rclpy
from benchmark_controller import node_command, process, run_delays
from diagnostic_msgs.msg import DiagnosticStatus
from lupa import lua54
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rich.console import Console
from rich.progress import track
from rich.table import Table
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger

from cell_double import CellDouble
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.live_cell.cell_graph import NodeDescription
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE
from robots_core.ros.running.middleware import choose_transports

PATIENCE = 30.0  # s
PROMISED = 500.0  # ms until a service of the program's node answers
STATEMENTS = 3_000_000  # of each run: some tenths of a second
PROGRAMS = {
    'adding': ('local x = 0', 'x = x + 1', 1),
    'table and string': ('local t, s = {}, ""', 't[i % 100] = i  s = "a" .. i % 10', 2),
    'function call': ('local x = 0 local function f(a) return a + 1 end', 'x = f(x)', 2),
}
WAITING = 'wait(1e6)'
COMPUTING = 'local x = 0 while true do x = x + 1 end'
HANDLERS = """
onDigitalInput(1, true, function() setDigitalOutput(1, 1) end)
onDigitalInput(1, false, function() setDigitalOutput(1, 0) end)
setDigitalOutput(2, 1)
"""
STARTED = 'setDigitalOutput(2, 1) '
SERVICES = ('get_command_state', 'pause', 'resume', 'stop')


def loop(name: str, count: int) -> tuple[str, int]:
    """A program, and how many statements it runs."""
    before, body, statements = PROGRAMS[name]
    times = count // statements
    return f'{before}\nfor i = 1, {times} do {body} end', times * statements


def run_bare(text: str) -> float:
    """Seconds that a program takes in Lua as lupa has it, without hook and sandbox."""
    run = lua54.LuaRuntime(unpack_returned_tuples=True).compile(text)
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def run_sandboxed(text: str, folder: Path) -> float:
    """Seconds that it takes as robot program: stoppable at any time, in its memory."""
    path = folder / 'loop.lua'
    path.write_text(f'setDigitalOutput(1, 1)\n{text}\nsetDigitalOutput(1, 0)\n')
    times: list[float] = []
    program = LuaProgram(6, CellDouble(output_changed=lambda _: times.append(time.perf_counter())))
    program.open(path)
    program.run()
    if not program.join(10.0 * PATIENCE) or program.error is not None:
        raise SystemExit(f'the program has not ended well: {program.error}')
    start, end = times
    return end - start


def statement_rates(name: str, rounds: int, folder: Path) -> tuple[float, float]:
    """Statements per second, bare and as robot program; medians."""
    text, count = loop(name, STATEMENTS)
    bare, sandboxed = [], []
    for _ in range(rounds):
        bare.append(run_bare(text))
        sandboxed.append(run_sandboxed(text, folder))
    return count / float(np.median(bare)), count / float(np.median(sandboxed))


class Plc(Node):
    """Switches an input and waits for the output that the program's handler switches."""

    def __init__(self) -> None:
        super().__init__('plc')
        self.changed = threading.Condition()
        self.output: list[int] = []
        self.answered = 0
        self.state = ''
        self._inputs = self.create_publisher(UInt8MultiArray, 'digital_inputs', STATE)
        self._program_services = {
            name: self.create_client(Trigger, f'lua_program_node/{name}')
            for name in (*SERVICES, 'open', 'run')
        }
        self.create_subscription(UInt8MultiArray, 'digital_outputs', self._on_outputs, STATE)
        self.create_subscription(DiagnosticStatus, 'program_status', self._on_status, STATE)

    def _on_outputs(self, message: UInt8MultiArray, info: dict[str, int]) -> None:
        with self.changed:
            if list(message.data) != self.output:  # otherwise it is repeated
                self.output, self.answered = list(message.data), info['source_timestamp']
            self.changed.notify_all()

    def _on_status(self, message: DiagnosticStatus) -> None:
        with self.changed:
            self.state = diagnostic_values(message)['state']
            self.changed.notify_all()

    def until(self, condition: Callable[[], bool]) -> None:
        with self.changed:
            if not self.changed.wait_for(condition, PATIENCE):
                raise SystemExit(f'the program does not answer: it is {self.state}')

    def answer(self, service: str) -> float:
        """Milliseconds from the call of a service of the program's node to its answer."""
        client = self._program_services[service]
        if not client.wait_for_service(PATIENCE):
            raise SystemExit(f'~/{service} was not found')
        start, done = time.perf_counter(), threading.Event()
        future = client.call_async(Trigger.Request())
        future.add_done_callback(lambda _: done.set())
        if not done.wait(PATIENCE) or not future.result().success:
            raise SystemExit(f'~/{service} was not answered, or refused')
        return 1e3 * (time.perf_counter() - start)

    def delay(self, value: int) -> float:
        """Milliseconds from an input to the output of its handler, by the middleware's stamp of it."""
        start = time.time_ns()
        self._inputs.publish(UInt8MultiArray(data=[value]))
        self.until(lambda: self.output[:1] == [value])
        return 1e-6 * (self.answered - start)


@contextmanager
def running_program(robot: str, text: str, folder: Path) -> Iterator[Plc]:
    """A program in a robot's nodes, which is what switches on digital output 2."""
    path = folder / 'program.lua'
    path.write_text(text)
    parameters = {'robot_model': robot, 'program': str(path), 'autostart': True}
    node = NodeDescription('robots_controller', 'lua_program_node', parameters)
    # Autostart waits for a robot that can move.
    parts = [NodeDescription('robots_core', 'drive_node', {'robot_model': robot})]
    parts += [NodeDescription('robots_controller', 'controller_node', {'robot_model': robot})]
    parts += [NodeDescription('robots_planning', 'planning_node', {'robot_model': robot})]
    rclpy.init()
    plc, executor = Plc(), SingleThreadedExecutor()
    executor.add_node(plc)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    with ExitStack() as processes:
        for part in (*parts, node):
            processes.enter_context(process(*node_command(part)))
        plc.until(lambda: plc.output[1:2] == [1])
        yield plc
    executor.shutdown()
    thread.join()
    plc.destroy_node()
    rclpy.shutdown()


def run_inputs(robot: str, rounds: int, main_part: str, folder: Path) -> np.ndarray:
    """Delays from an input topic to the Lua handler's output topic, ms."""
    with running_program(robot, HANDLERS + main_part, folder) as plc:
        delays = []
        for number in track(range(2 * rounds), description=f'inputs: {main_part[:8]}', transient=True):
            delays.append(plc.delay(1 - number % 2))
            time.sleep(0.02)  # between the handlers, so that each interrupts the main part
    return np.array(delays)


def run_services(robot: str, rounds: int, folder: Path) -> dict[str, np.ndarray]:
    """Times from a call of each service to its answer, ms, while the program computes without end."""
    answers: dict[str, list[float]] = {name: [] for name in SERVICES}
    with running_program(robot, STARTED + COMPUTING, folder) as plc:
        for _ in track(range(rounds), description='services', transient=True):
            for name in SERVICES:
                answers[name].append(plc.answer(name))
            plc.until(lambda: plc.state == 'STOPPED')
            for name in ('open', 'run'):
                plc.answer(name)
            plc.until(lambda: plc.state == 'RUNNING')
    return {name: np.array(times) for name, times in answers.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--robot', default='kuka_kr210_r2700')
    parser.add_argument('--rounds', type=int, default=7, help='of each program')
    parser.add_argument('--inputs', type=int, default=100, help='changes of the input, up and down each')
    parser.add_argument('--answers', type=int, default=50, help='calls of each service')
    options = parser.parse_args()
    choose_transports()
    console = Console()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        table = Table(title=f'Lua statements per second, medians of {options.rounds}')
        for column in ('', 'bare Lua 5.4', 'robot program', 'ratio of times'):
            table.add_column(column, justify='right')
        for program in track(PROGRAMS, description='statements', transient=True):
            bare, sandboxed = statement_rates(program, options.rounds, folder)
            table.add_row(
                program, f'{1e-6 * bare:.1f} M', f'{1e-6 * sandboxed:.1f} M', f'{bare / sandboxed:.2f}'
            )
        console.print(table)
        for words, main_part in (('waits', WAITING), ('computes', COMPUTING)):
            delays = run_inputs(options.robot, options.inputs, main_part, folder)
            console.print(
                f"input topic to its Lua handler's output while the program {words}, {delays.size} changes: "
                f'median {np.median(delays):.1f} ms, p99 {np.percentile(delays, 99.0):.1f} ms'
            )
        for service, times in run_services(options.robot, options.answers, folder).items():
            console.print(
                f'call of ~/{service} to its answer while the program computes, {times.size} calls: '
                f'median {np.median(times):.1f} ms, worst {times.max():.1f} ms; promised are {PROMISED:g} ms'
            )
    moves = run_delays(options.robot)
    console.print(
        f'Lua motion call to first changed reference at 250 Hz, {moves.size} moves: '
        f'median {np.median(moves):.1f} ms, worst {moves.max():.1f} ms'
    )


if __name__ == '__main__':
    main()

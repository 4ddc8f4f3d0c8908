"""The one place that spins: start a node, serve it, and end it cleanly."""

import faulthandler
import gc
import inspect
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import try_shutdown

from robots_core.errors import RobotsError
from robots_core.exit_codes import ExitCode
from robots_core.process_end import STDERR, bounded_end, end_quickly
from robots_core.ros.lockstep.lead import Lead
from robots_core.ros.peers.heartbeat import Heartbeat, NamesakeWatch
from robots_core.ros.running.interrupt import interrupt
from robots_core.ros.running.lean_executor import HUNG, ExecutorWatch, LeanExecutor
from robots_core.ros.running.middleware import choose_transports
from robots_core.ros.running.node_help import check_parameter_names, help_requested, help_text
from robots_core.ros.timed_node import TimedNode


def run(make_node: Callable[[], TimedNode], args: list[str] | None = None) -> int:
    """Run a node, see `run_nodes`; or print what it is, with `--help`."""
    if help_requested(args):
        print(help_text(make_node))
        return ExitCode.OK
    return run_nodes([make_node], args)


def run_nodes(make_nodes: Sequence[Callable[[], TimedNode]], args: list[str] | None = None) -> int:
    """Run nodes in this process until it is interrupted or its context is shut down.

    A mistake of the user (a `RobotsError`) is reported in one line, without traceback.

    Args:
        make_nodes: Create the nodes once ROS is initialised.
        args: Command line; `sys.argv` by default.

    Returns:
        Exit code: 0 after Ctrl-C or terminate, 2 if a node cannot start as configured, or beside
        another one of its name, 1 for nodes that do not end, see `bounded_end`.
    """
    end_quickly()
    choose_transports()
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    nodes: list[TimedNode] = []
    executor: LeanExecutor | None = None
    heartbeats: list[Heartbeat] = []

    def wake() -> None:
        if executor is None:
            # Models and compiled code may take long to load, and there is nothing to close yet.
            sys.stdout.flush()
            os._exit(0)
        executor.create_task(lambda: None)  # woken alone, an executor with nothing to do waits on

    with interrupt(wake) as stopping:
        try:
            nodes.extend(make_node() for make_node in make_nodes)
            check_parameter_names(nodes, args)
            # A logger looks for its caller, the first time through all modules: not while a robot moves.
            inspect.getmodule(run_nodes.__code__)
            executor = LeanExecutor()
            for node in nodes:
                executor.add_node(node)
            watch = ExecutorWatch(executor, partial(_report_hung, nodes[0]))
            for node in nodes:
                if not node.simulated_time:
                    heartbeats.append(Heartbeat(node, watch.check))
                    if node.alone:
                        NamesakeWatch(node, heartbeats[-1])
            gc.freeze()  # what exists now is kept as long as the node
            go_on = _go_on(nodes)
            while nodes[0].context.ok() and not stopping.is_set():
                executor.spin_once()
                go_on()
        except ExternalShutdownException:
            return ExitCode.OK
        except RobotsError as error:
            print(error.line_for_person, file=sys.stderr)
            return ExitCode.BAD_INPUT
        finally:
            with bounded_end():
                _end(nodes, heartbeats, executor)
    return ExitCode.OK


def _report_hung(node: TimedNode) -> None:
    node.journal.error(
        f'a callback has not returned for {HUNG:g} s: no more signs of life until it does; all threads:'
    )
    faulthandler.dump_traceback(STDERR)


def _go_on(nodes: Sequence[TimedNode]) -> Callable[[], None]:
    """What several nodes in lock-step do after each callback."""
    participants = [node.participant for node in nodes if node.participant is not None]
    return Lead(participants).go_on if len(participants) > 1 else lambda: None


def _end(nodes: Sequence[TimedNode], heartbeats: Sequence[Heartbeat], executor: LeanExecutor | None) -> None:
    for heartbeat in heartbeats:
        heartbeat.stop()
    # The page, the bag and the last messages are closed before another signal may end the process. The first
    # node reports for all in lock-step, and others still publish when they end.
    for node in (*nodes[1:], *nodes[:1]):
        node.destroy_node()
    if executor is not None:
        executor.shutdown()
    try_shutdown()
